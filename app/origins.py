"""Where each number on the page comes from, a short text for each."""

import tomllib
from functools import cache
from html import escape

from app.static_files import static_text


@cache
def origins() -> dict[str, tuple[str, str]]:
    """Name on the page and text, by field."""
    return {field: (name, text) for field, (name, text) in tomllib.loads(static_text("origins.toml")).items()}


def origins_html() -> str:
    """All of them, each to be unfolded."""
    folded = (
        f'<details data-origin="{field}"><summary>{escape(name)}</summary><p>{escape(text)}</p></details>'
        for field, (name, text) in origins().items()
    )
    return f'<div class="rr-help rr-origins" data-testid="origins">{"".join(folded)}</div>'
