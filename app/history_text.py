"""The record's list and one entry of it as HTML; every text from outside is escaped."""

from html import escape

from app.origins import from_
from app.record.entries import Head
from app.record.history import Line, Listing
from app.wording import from_to, measured
from rotrecon.primitives import in_words

NOTHING_FOUND = "Nothing of that kind is in the record."


def list_html(listing: Listing, problem: str | None) -> str:
    """A page of the list, newest first."""
    if problem is not None:
        return f'<div class="rr-caption rr-amber" data-testid="history" {from_("recorded")}>{escape(problem)}</div>'
    chosen = None if listing.chosen is None else listing.chosen.number
    rows = "".join(_row(line, line.number == chosen) for line in listing.lines) or f"<p>{NOTHING_FOUND}</p>"
    return f'<div class="rr-history" data-testid="history" {from_("recorded")}>{rows}</div>'


def entry_html(line: Line | None, told: str, good: bool) -> str:
    """The entry that is looked at, with what has come of what was asked of it."""
    if line is None:
        return '<div class="rr-caption rr-dim" data-testid="entry">Choose an entry by its number.</div>'
    style = "rr-sure" if good else "rr-unsure"
    outcome = f'<div class="{style}" data-testid="told" data-same="{str(good).lower()}">{escape(told)}</div>'
    return (
        f'<div class="rr-caption" data-testid="entry" data-entry="{line.number}" {from_("recorded")}>'
        f"<b>Entry {line.number}: {escape(line.kind)}</b> by {escape(line.who)}, {_when(line)}"
        f"{outcome if told else ''}</div>"
    )


def typed_in(listing: Listing) -> set[str]:
    """What people have typed, of which nothing may be told in another unit."""
    return {escape(text) for line in listing.lines for text in (line.said, line.tool, line.who) if text}


def head_html(head: Head) -> str:
    """What the record ends with."""
    return (
        f'<div class="rr-caption rr-dim" {from_("head")}>Head of the record: '
        f'<code class="rr-hash" data-testid="head">{head}</code></div>'
    )


def _row(line: Line, is_chosen: bool) -> str:
    picture = f'<img src="{escape(line.picture)}" alt="">' if line.picture else "<span></span>"
    style = " rr-chosen" if is_chosen else ""
    return (
        f'<div class="rr-entry{style}" data-entry="{line.number}" data-kind="{escape(line.kind)}">{picture}'
        f"<div><b>{line.number} {escape(line.kind)}</b> <small>{_when(line)}, {escape(line.who)}</small>"
        f"<div>{escape(_what(line))}</div><small>{escape(line.said)}</small></div></div>"
    )


def _what(line: Line) -> str:
    """What was measured, and for which tool."""
    answer = line.answer
    if answer is None:
        return line.tool or ""
    if answer["kind"] is None:
        return "nothing could be measured"
    interval = answer["interval_mm"]
    size = measured(answer["diameter_mm"], interval, " mm")
    ends = "" if interval is None or "±" in size else f" ({from_to(interval, ' mm')})"
    return f"{in_words(answer['kind'])}, ⌀ {size}{ends}; {line.tool or 'no tool'}"


def _when(line: Line) -> str:
    return f"{line.when[:19].replace('T', ' ')} UTC"
