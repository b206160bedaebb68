"""What was recorded: one frame whose depth is known, or several views that still have to be matched."""

from dataclasses import dataclass, field
from datetime import datetime

import numpy as np

from rotrecon.arrays import Bytes, Cloud, Floats, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.workspace import Workspace


@dataclass(frozen=True)
class StereoNoise:
    """A stereo camera errs in disparity, by the same amount at every depth: sigma_z = z^2 sigma_d / (f b)."""

    baseline_m: float
    disparity_sigma_px: float


@dataclass(frozen=True)
class DepthCameraNoise:
    """A depth camera whose error has a floor and grows with the square of depth: sigma_z = sigma0 + sigma2 z^2."""

    sigma0_m: float
    sigma2_per_m: float


DepthNoise = StereoNoise | DepthCameraNoise


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture with an organised cloud behind it; every pixel coordinate in the program is one of this picture."""

    image: Bytes
    """(height, width, 3) RGB."""
    points_m: Cloud
    """(height, width, 3) float32 in camera coordinates; NaN in all three where there is no depth."""
    camera: PinholeCamera
    T_base_camera: Floats = field(default_factory=lambda: np.eye(4))
    """(4, 4) rigid."""
    noise: DepthNoise | None = None
    """None where the scene does not state it."""
    workspace: Workspace = Workspace()
    captured_at: datetime | None = None

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def depth_m(self) -> Cloud:
        """(height, width) depth along z; NaN where there is none. A view into `points_m`."""
        return self.points_m[..., 2]


@dataclass(frozen=True, eq=False)
class View:
    """One undistorted picture from a known pose, not yet matched with another."""

    image: Bytes
    """(height, width, 3) RGB."""
    camera: PinholeCamera
    T_base_camera: Floats
    """(4, 4) rigid."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True)
class FrameUnavailable:
    """Why a capture cannot be turned into a frame, and what would help."""

    reason: str


@dataclass(frozen=True, eq=False)
class Capture:
    """A recording as it was read: either `recorded` is a frame, or `views` are two or more."""

    name: str
    recorded: Frame | None = None
    views: tuple[View, ...] = ()
    notes: tuple[str, ...] = ()
    """What a reader should know of how it was made, such as intrinsics that had to be recovered."""

    def frame(self) -> Frame | FrameUnavailable:
        """The frame to measure in: the recorded one; views need stereo matching, which this version has not."""
        if self.recorded is not None:
            return self.recorded
        return FrameUnavailable(
            f"{self.name} holds {len(self.views)} views and needs stereo matching, which this version cannot do; "
            "open a scene whose depth is recorded"
        )
