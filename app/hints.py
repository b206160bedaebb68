"""What the operator can do next, in one line."""

from app.events import Refused
from app.session import Session, sentence
from rotrecon.fitting import FitFailure


def hint(session: Session) -> str:
    """What the operator can do next, in one line."""
    if session.vertices_px:
        if session.notice is not None:
            return session.notice.text + " Backspace takes a corner back."
        missing = 3 - len(session.vertices_px)
        if missing > 0:
            corners = "one more corner" if missing == 1 else f"{missing} more corners"
            return f"Click {corners} round the object. Escape drops the polygon."
        return "Click the next corner, or the first one (or Enter) to close the polygon. Escape drops it."
    shown = session.shown
    if shown.area is None and shown.axis is None:
        return "Drag a rectangle round the object, or click the corners of a polygon."
    if shown.area is None:
        return "Now draw the area: drag a rectangle round the object."
    if shown.axis is None:
        return "Now draw the object's axis: shift + drag along its middle, or choose Axis."
    if session.preview is not None:
        return "Let go where it is right; the result follows."
    if not session.up_to_date:
        return "Measuring \N{HORIZONTAL ELLIPSIS}"
    if session.measured is not None and isinstance(session.measured.outcome, Refused):
        return sentence(session.measured.outcome.reason)
    if session.reconstruction is not None and isinstance(session.reconstruction.fit, FitFailure):
        return sentence(session.reconstruction.fit.advice)
    return "Measured. Drag the handles to correct the drawing, or draw anew for another object."
