"""What the operator can do next, in one line."""

from app.events import Refused
from app.session import Session, sentence
from app.tool_text import trouble
from rotrecon.outcome import Fit, FitFailure
from rotrecon.reconstruction import Reconstruction
from rotrecon.tools import NoTool


def warning(session: Session) -> str | None:
    """Why there is no result or no sure tool for what is shown, as a sentence; nothing while it is being drawn."""
    if session.vertices_px:
        return None if session.notice is None else session.notice.text + " Backspace takes a corner back."
    if session.preview is not None or session.measured is None or not session.up_to_date:
        return None
    match session.measured.outcome:
        case Refused(reason=why) | Reconstruction(fit=FitFailure(advice=why) | Fit(doubts=(why, *_))):
            return sentence(why)
        case Reconstruction(tool=NoTool(unsure=(why, *_))):
            return sentence(why)
        case Reconstruction() as result:
            why = trouble(result)
            return None if why is None else sentence(why)
        case _:
            return None


def hint(session: Session, led: str | None = None) -> str:
    """What the operator can do next, in one line; `led` is what a tour says, where there is nothing more urgent."""
    warned = warning(session)
    if warned is not None:
        return warned
    if session.vertices_px:
        missing = 3 - len(session.vertices_px)
        if missing > 0:
            corners = "one more corner" if missing == 1 else f"{missing} more corners"
            return f"Click {corners} round the object. Escape drops the polygon."
        return "Click the next corner, or the first one (or Enter) to close the polygon. Escape drops it."
    shown = session.shown
    if shown.area is None and shown.axis is None:
        return led or "Drag a rectangle round the object, or click the corners of a polygon."
    if shown.area is None:
        choose = "choose Area, and " if session.tool == "axis" else ""
        return f"Now draw the area: {choose}drag a rectangle round the object."
    if session.preview is not None:
        return "Let go where it is right; the result follows."
    if not session.up_to_date:
        if session.measured_once:
            return "Measured coarsely; the area is being matched again, finely \N{HORIZONTAL ELLIPSIS}"
        return "Measuring \N{HORIZONTAL ELLIPSIS}"
    if led is not None:
        return led
    if shown.proposed:
        return "Measured. The axis is proposed: drag its ends, or draw another (shift + drag, or choose Axis)."
    if session.reconstruction is not None and session.reconstruction.drawing.axis != shown.axis:
        return "Measured along the object's own axis: the one you drew is short of it, or off it."
    return "Measured. Drag the handles to correct the drawing, or draw anew for another object."
