"""What a pointer did on the picture or on a handle, in pixels of the frame."""

import numpy as np
from viser import SceneNodeDragEvent, SceneNodePointerEvent

from app.object_drawing import Pixel
from rotrecon.arrays import Floats
from rotrecon.camera import inverse, rotate, transform
from rotrecon.frame import Frame

Triple = tuple[float, float, float]


class PixelFinder:
    """Finds the pixel under a point of the scene: in the camera view all points of a sight line are one pixel."""

    def __init__(self, frame: Frame) -> None:
        self._camera = frame.camera
        self._T_camera_base = inverse(frame.T_base_camera)

    def pixel(self, point_m: Triple) -> Pixel:
        """Pixel of a point in base coordinates."""
        u, v = self._camera.project(transform(self._T_camera_base, np.asarray(point_m)))
        return (float(u), float(v))

    def clicked(self, event: SceneNodePointerEvent) -> Pixel:
        """Pixel that was clicked."""
        return self.pixel(tuple(np.add(event.ray_origin, event.ray_direction)))

    def sight_line(self, origin_m: Triple, direction: Triple) -> tuple[Floats, Floats]:
        """Origin and direction of a sight line in camera coordinates, given in base coordinates."""
        T = self._T_camera_base
        return transform(T, np.asarray(origin_m)), rotate(T, np.asarray(direction))

    def dragged(self, event: SceneNodeDragEvent) -> tuple[Pixel, Pixel]:
        """Pixels where a drag started and where it is."""
        return self.pixel(event.start_position), self.pixel(event.end_position)
