"""Simulated poses of the paper's three objects, and the depth that different stereo cameras would give of them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from rotrecon.axis import Axis
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame
from rotrecon.primitives import Kind
from rotrecon.simulation.simulate import Simulated, simulate
from rotrecon.simulation.stereo_noise import StereoErrors, stereo_depth

CAMERA = PinholeCamera(1280, 720, np.array([[900.0, 0, 639.5], [0, 900.0, 359.5], [0, 0, 1]]))
STEREO = StereoErrors(baseline_m=0.1)
KINDS: dict[str, Kind] = {"leg": "cylinder", "ball": "sphere", "wire": "rod"}


@dataclass(frozen=True, eq=False)
class Pose:
    """One object before the camera, and what is true of it."""

    simulated: Simulated

    @property
    def drawing(self) -> Drawing:
        """An ideal operator's, who names the kind too."""
        return replace(self.simulated.drawing, kind=KINDS[self.simulated.object_name])

    @property
    def radius_m(self) -> float:
        """Of the object."""
        return self.simulated.solid.radius_m

    @property
    def tilt_deg(self) -> float:
        """Of the axis out of the picture's plane."""
        return float(np.degrees(np.arcsin(abs(self.simulated.solid_in_camera.direction[2]))))

    @property
    def axis(self) -> Axis:
        """The true one, the way the stroke goes."""
        solid, stroke = self.simulated.solid_in_camera, self.simulated.drawing.stroke
        start, ahead = CAMERA.project(solid.center_m + np.outer([0, 1e-3], solid.direction))
        forward = (ahead - start) @ np.subtract(stroke.end_px, stroke.start_px) > 0
        return Axis(solid.center_m, solid.direction if forward else -solid.direction)

    def frame(self, errors: StereoErrors | None) -> Frame:
        """The frame with such errors of depth, None for exact; the random numbers do not depend on the errors."""
        if errors is None:
            return self.simulated.frame
        rng = np.random.default_rng([self.simulated.seed, *self.simulated.object_name.encode()])
        depth_m = stereo_depth(self.simulated.view, errors, rng)
        return replace(self.simulated.frame, points_m=CAMERA.cloud(depth_m))


def poses(object_name: str, count: int) -> Iterator[Pose]:
    """The object in `count` poses, seeds 0, 1, 2, ..."""
    for seed in range(count):
        yield Pose(simulate(object_name, seed, CAMERA, noise=None, supersampling=1))
