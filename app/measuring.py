"""A drawing measured, whatever happens: what is wrong with it, or with the program, comes back in words."""

import logging
from collections.abc import Callable

from app.events import Refused
from rotrecon.capture import Capture
from rotrecon.drawing import Drawing, DrawingError
from rotrecon.frame import Frame, FrameUnavailable
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings

log = logging.getLogger(__name__)


def measure(frame: Frame, drawing: Drawing, settings: Settings) -> Reconstruction | Refused:
    """The reconstruction, or the reason why there is none."""
    return _measured(lambda: frame, drawing, settings)


def measure_finely(capture: Capture, drawing: Drawing, settings: Settings) -> Reconstruction | Refused:
    """The same on depth that is matched for the area of the drawing."""
    return _measured(lambda: capture.frame(drawing.area, settings), drawing, settings)


def _measured(
    frame_of: Callable[[], Frame | FrameUnavailable], drawing: Drawing, settings: Settings
) -> Reconstruction | Refused:
    try:
        frame = frame_of()
        return Refused(frame.reason) if isinstance(frame, FrameUnavailable) else reconstruct(frame, drawing, settings)
    except DrawingError as error:
        return Refused(str(error))
    except Exception:
        log.exception("the measurement of %s failed", drawing)
        return Refused("the program failed on this drawing, which is its own mistake; undo, and draw it another way")
