"""A drawing measured, whatever happens: what is wrong with it, or with the program, comes back in words."""

import logging

from app.events import Refused
from rotrecon.drawing import Drawing, DrawingError
from rotrecon.frame import Frame
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings

log = logging.getLogger(__name__)


def measure(frame: Frame, drawing: Drawing, settings: Settings) -> Reconstruction | Refused:
    """The reconstruction, or the reason why there is none."""
    try:
        return reconstruct(frame, drawing, settings)
    except DrawingError as error:
        return Refused(str(error))
    except Exception:
        log.exception("the measurement of %s failed", drawing)
        return Refused("the program failed on this drawing, which is its own mistake; undo, and draw it another way")
