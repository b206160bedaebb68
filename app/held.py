"""The frame that everybody works on, and the one that has come after it."""

from dataclasses import dataclass
from datetime import datetime

from app.deciding.watchdog import FrameFacts
from rotrecon.capture import Capture
from rotrecon.frame import Frame


@dataclass(frozen=True, eq=False)
class Held:
    """A frame that is drawn on and measured in until the operator takes another one."""

    frame: Frame
    name: str
    capture: Capture
    """The recording that the frame is of."""
    notes: tuple[str, ...] = ()
    """What an operator should know of how it was made."""
    entry: int | None = None
    """Of the record, from which it was opened again."""

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height."""
        return (self.frame.camera.width, self.frame.camera.height)

    @property
    def finely(self) -> Capture | None:
        """Views of which the frame is the coarse one, to be matched again in every area that is drawn."""
        return self.capture if self.capture.views else None


@dataclass(frozen=True, eq=False)
class Newer:
    """A recording that has come after the frame that is held."""

    number: int
    """Grows with every one that comes."""
    capture: Capture
    who: str
    """Who pushed it in."""
    arrived_at: datetime
    facts: FrameFacts
    unusable: str | None = None
    """Why no frame could be made of it, and what to do."""


@dataclass(frozen=True)
class Taking:
    """A newer recording that is being made the held frame."""

    newer: Newer
    matching: bool = False
    """Whether its views are prepared and the whole picture is being matched."""
