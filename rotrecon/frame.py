"""What is measured in: a picture with depth behind it, the views it was matched from, and what its depths err by."""

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
class View:
    """One undistorted picture from a known pose."""

    image: Bytes
    """(height, width, 3) RGB."""
    camera: PinholeCamera
    T_base_camera: Floats
    """(4, 4) rigid."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True)
class StereoEvidence:
    """What is known of a frame that was matched from views, besides its depth."""

    pairs: tuple[int, ...]
    """Numbers of the views that the first one, number 0, was matched with."""
    left_out: tuple[str, ...]
    """Views that are not used, each with the reason."""
    epipolar_error_px: float | None
    """How far matched features lie off the row that the poses and cameras put them in: median of the worst pair; None
    where there are too few to say."""
    features: int
    """Matched features that say so, of all pairs."""
    valid_share: float
    """Share of the pixels with depth: in the area, or in the frame where the whole of it was matched."""
    disparities_px: tuple[float, float]
    """Smallest and largest that were looked for, of the first pair."""
    window_px: int
    """Side of the blocks that were compared."""
    scale: float
    """1 where pictures were matched at full resolution."""


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
    views: tuple[View, ...] = ()
    """Undistorted pictures that the depth was matched from, the reference first; empty where it was recorded."""
    stereo: StereoEvidence | None = None

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def depth_m(self) -> Cloud:
        """(height, width) depth along z; NaN where there is none. A view into `points_m`."""
        return self.points_m[..., 2]


@dataclass(frozen=True)
class FrameUnavailable:
    """Why a capture cannot be turned into a frame, and what would help."""

    reason: str
