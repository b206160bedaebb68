"""The simulated clouds: what a camera's depth is made of in each cell of the tables, and what is true of it."""

import zlib
from dataclasses import dataclass, replace
from typing import Literal

import cv2
import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame
from rotrecon.primitives import Simple, Sphere
from rotrecon.simulation.ideal_drawing import perturb
from rotrecon.simulation.simulate import Simulated, simulate
from rotrecon.simulation.stereo_noise import StereoErrors, correlated_noise, stereo_depth

CAMERA = PinholeCamera(640, 480, np.array([[700.0, 0, 319.5], [0, 700.0, 239.5], [0, 0, 1]]))
MATCHED = StereoErrors()
"""The simulator's full model: windows of 7 x 7 px, correlated noise, growth over outlines, shadows, holes."""
FOCAL_BASELINE = CAMERA.focal_px * MATCHED.baseline_m
"""Disparity, px, times depth, m."""
OUTLIER_PX = 5.0
"""Outliers are spread evenly so far to both sides of the true disparity: 6 % of the depth at 0.9 m."""
KERNEL_PX = 4
"""Correlation of matched depth: a length, or the side of a box, both of which "a kernel of 4 px" can mean."""

NoiseKind = Literal["white", "length", "box", "matched"]


@dataclass(frozen=True)
class Cell:
    """What is wrong with a cloud's depth."""

    noise: NoiseKind
    """`length`: autocorrelation exp(-(lag / 4 px)^2); `box`: mean over 4 x 4 px; `matched`: the simulator's model."""
    sigma_px: float
    """Of disparity."""
    outlier_share: float = 0.0
    arc_deg: float | None = None
    """Object pixels beyond this arc have no depth; None for all that is seen."""

    @property
    def name(self) -> str:
        """As the tables have it."""
        outliers = f"{100 * self.outlier_share:.0f} % outliers, " if self.noise == "white" else ""
        arc = "full view" if self.arc_deg is None else f"{self.arc_deg:.0f} deg"
        return f"{self.noise} {self.sigma_px:g} px, {outliers}{arc}"


WHITE = tuple(
    Cell("white", sigma_px, share, arc_deg)
    for sigma_px in (0.25, 0.5)
    for share in (0.0, 0.05, 0.2)
    for arc_deg in (160.0, 120.0)
)
CORRELATED = (Cell("length", 0.15), Cell("box", 0.15))
FULL_MODEL = Cell("matched", MATCHED.disparity_sigma_px)


@dataclass(frozen=True, eq=False)
class Pose:
    """One object before the camera, its exact depth cast once for all cells."""

    simulated: Simulated
    lateral: Bools
    """(H, W) which pixels show the object's surface of revolution, its caps left out."""
    from_middle_rad: Floats
    """(H, W) angle round the axis, or the ball, between a pixel's point and the camera; NaN off the object."""
    along_m: Floats
    """(H, W) position of a pixel's point along the axis, from the solid's middle; NaN off the object."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def solid(self) -> Simple:
        """The truth, in camera coordinates."""
        return self.simulated.solid_in_camera


@dataclass(frozen=True, eq=False)
class Cloud:
    """What a program is given, and what is true of it."""

    object_name: str
    frame: Frame
    drawing: Drawing
    truth: Simple
    """In camera coordinates."""
    surface: Bools
    """(H, W) pixels of the object's surface with a depth, as drawn and between the stroke's ends."""
    own: Bools
    """(H, W) those whose depth is no outlier."""
    place_m: Floats
    """(3,) where radii are compared: on the true axis in the middle of those pixels, or the ball's centre."""
    sigma_px: float
    seed: int
    """Of the noise; for whoever draws random samples."""

    def __post_init__(self) -> None:
        freeze(self)


def pose_of(object_name: str, seed: int, supersampling: int = 0) -> Pose:
    """An object in the pose of a seed; its picture, which only the full model shows, is black without samples."""
    simulated = simulate(object_name, seed, CAMERA, noise=None, supersampling=supersampling)
    angle, along = np.full((2, CAMERA.height, CAMERA.width), np.nan)
    solid, mask = simulated.solid_in_camera, simulated.view.mask
    points = _points(simulated)[mask]
    angle[mask] = _from_middle(solid, points)
    along[mask] = (points - solid.center_m) @ solid.direction
    lateral = mask.copy()
    lateral[mask] = np.abs(solid.distance(points)) < 1e-6
    return Pose(simulated, lateral, angle, along)


def cloud_of(pose: Pose, cell: Cell, draw: int = 0) -> Cloud:
    """The pose with the errors of a cell and an unsteady hand's drawing; another `draw`, another noise.

    But for the full model its picture is black, so that depth alone is measured.
    """
    simulated = pose.simulated
    key = [simulated.seed, draw, zlib.crc32(f"{simulated.object_name} {cell.name}".encode())]
    noise, hand = np.random.default_rng(key).spawn(2)
    depth_m, outlier = _depth(pose, cell, noise)
    if cell.arc_deg is not None:
        depth_m[pose.from_middle_rad > np.radians(cell.arc_deg) / 2] = np.nan
    drawing = perturb(simulated.drawing, hand)
    image = simulated.frame.image if cell.noise == "matched" else np.zeros_like(simulated.frame.image)
    surface = inside(drawing) & np.isfinite(depth_m) & pose.lateral
    own = surface & ~outlier
    return Cloud(
        simulated.object_name,
        replace(simulated.frame, image=image, points_m=CAMERA.cloud(depth_m), noise=None),
        drawing,
        pose.solid,
        surface,
        own,
        _place(pose, own),
        cell.sigma_px,
        key[-1],
    )


def _place(pose: Pose, own: Bools) -> Floats:
    if isinstance(pose.solid, Sphere):
        return pose.solid.center_m
    along = pose.along_m[own]
    return pose.solid.center_m + (along.min() + along.max()) / 2 * pose.solid.direction


def inside(drawing: Drawing) -> Bools:
    """(H, W) pixels inside a drawing's area and between the ends of its stroke."""
    assert drawing.axis is not None
    mask = np.zeros((CAMERA.height, CAMERA.width), dtype=np.uint8)
    cv2.fillPoly(mask, [np.rint(np.array(drawing.area.vertices_px)).astype(np.int32)], 1)
    start, end = np.array(drawing.axis.start_px), np.array(drawing.axis.end_px)
    du, dv = (end - start) / ((end - start) @ (end - start))
    along = (np.arange(CAMERA.width) - start[0]) * du + ((np.arange(CAMERA.height) - start[1]) * dv)[:, None]
    return (mask > 0) & (along >= 0) & (along <= 1)


def _depth(pose: Pose, cell: Cell, rng: np.random.Generator) -> tuple[Floats, Bools]:
    """Depth (H, W) with a cell's errors, and which pixels are outliers."""
    view = pose.simulated.view
    if cell.noise == "matched":
        return stereo_depth(view, MATCHED, rng), np.zeros(view.depth_m.shape, dtype=bool)
    exact = FOCAL_BASELINE / view.depth_m
    disparity = exact + cell.sigma_px * _unit_noise(cell.noise, exact.shape, rng)
    outlier = rng.random(exact.shape, dtype=np.float32) < cell.outlier_share
    disparity[outlier] = exact[outlier] + rng.uniform(-OUTLIER_PX, OUTLIER_PX, int(outlier.sum()))
    disparity[disparity <= 0] = np.nan
    return FOCAL_BASELINE / disparity, outlier


def _unit_noise(kind: NoiseKind, size: tuple[int, ...], rng: np.random.Generator) -> Floats:
    """Noise (H, W) of standard deviation 1."""
    if kind == "box":
        kernel = (KERNEL_PX, KERNEL_PX)
        return KERNEL_PX * np.asarray(cv2.blur(rng.standard_normal(size), kernel), dtype=np.float64)
    return correlated_noise(size, KERNEL_PX if kind == "length" else 0.0, rng)


def _points(simulated: Simulated) -> Floats:
    v, u = np.indices(simulated.view.depth_m.shape)
    return CAMERA.unproject(np.stack([u, v], axis=-1), simulated.view.depth_m)


def _from_middle(solid: Simple, points_m: Floats) -> Floats:
    """Angle (N,) between the surface at points (N, 3) and the camera, which is the origin."""
    offset, toward = points_m - solid.center_m, -solid.center_m
    if not isinstance(solid, Sphere):
        offset = offset - np.outer(offset @ solid.direction, solid.direction)
        toward = toward - (toward @ solid.direction) * solid.direction
    cosine = (offset @ toward) / (np.linalg.norm(offset, axis=1) * np.linalg.norm(toward))
    return np.arccos(np.clip(cosine, -1.0, 1.0))
