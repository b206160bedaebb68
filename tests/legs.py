"""A measured chair leg, of which it is tested what is shown."""

from functools import cache

from app.events import Reconstructed
from app.object_drawing import ObjectDrawing
from app.session import Session, step
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated, simulate


@cache
def leg() -> Simulated:
    return simulate("leg", 0)


@cache
def measured_leg() -> Reconstruction:
    return reconstruct(leg().frame, leg().drawing, Settings(layers=3))


def session_of(result: Reconstruction) -> Session:
    """The session that has just been told of a result."""
    camera = result.frame.camera
    drawn = ObjectDrawing(result.drawing.area, result.drawing.axis)
    return step(Session((camera.width, camera.height), (drawn,)), Reconstructed(0, result))
