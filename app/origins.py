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


def from_(*fields: str) -> str:
    """Attributes of an element whose numbers come from these: by name, and in words when it is pointed at."""
    texts = (": ".join(origins()[field]) for field in fields)
    return f'data-from="{" ".join(fields)}" title="{escape(" ".join(texts))}"'


@cache
def field_named(name: str) -> str:
    """The field of a name on the page, whatever its capitals; raises KeyError."""
    return {known.casefold(): field for field, (known, _) in origins().items()}[name.casefold()]
