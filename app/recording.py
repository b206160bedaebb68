"""What has to be on disk before anybody is told: the decision's outbox, written."""

from collections.abc import Callable

from app.clock import seconds
from app.deciding.events import NotWritten, Written
from app.record.entries import Entry
from app.record.errors import StoreError
from app.record.store import Record
from rotrecon.frame import Frame

NO_RECORD = "this console was started without a record"
CHANGED = "the evidence is not what was proposed"
FINAL = ("confirmed", "overridden")


def write(
    record: Record | None,
    outbox: tuple[Entry, ...],
    frame_of: Callable[[Entry], Frame],
    digest: Callable[[], str | None],
) -> tuple[Written | NotWritten, ...]:
    """Put entries on disk in their order, and with evidence its frame; what became of it, as events.

    `digest` works out that of the evidence as it is now, which a confirmation is compared with once more.
    """
    count, why = 0, None
    try:
        for entry in outbox:
            if record is None:
                raise StoreError(NO_RECORD)
            if entry.kind in FINAL and entry.digest != digest():
                raise StoreError(CHANGED)
            record.append(entry, frame_of(entry) if "evidence" in entry.payload else None)
            count += 1
    except StoreError as error:
        why = str(error)
    written = (Written(seconds(), count),) if count else ()
    return written if why is None else (*written, NotWritten(seconds(), why))
