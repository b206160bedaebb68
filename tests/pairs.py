"""Pictures of one object from two places, small and close so that they are cheap, and a scene to refine it in."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera, transform
from rotrecon.drawing import Drawing, cut_sections
from rotrecon.frame import Frame, StereoNoise, View
from rotrecon.primitives import Frustum, Sphere
from rotrecon.rays.ball import Ball
from rotrecon.rays.hypotheses import Scene, scene_of
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.patch import patch_of
from rotrecon.rays.ray_fit import RayFit, Sight, fine
from rotrecon.rays.surfaces import Surface, turn_of
from rotrecon.simulation.ideal_drawing import ideal_drawing
from rotrecon.simulation.rendering import Body, World, render
from rotrecon.simulation.scenery import concrete, plane_behind
from rotrecon.simulation.surfaces import Texture, textured

CAMERA = PinholeCamera(240, 180, np.array([[300.0, 0, 130.0], [0, 300.0, 89.5], [0, 0, 1]]))
BASELINE_M = 0.06
NOISE_LEVELS = 1.5
LEG = Frustum("cylinder", np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.17, 0.03, 0.0)
CONE = Frustum("cone", np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.12, 0.045, float(np.deg2rad(15)))
BALL = Sphere(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.05)


@dataclass(frozen=True)
class Pair:
    """Views of one object, and what is true of it."""

    frame: Frame
    """Its depth is exact but for independent noise of a fifth of a pixel."""
    surface: Surface
    """True, in camera coordinates."""
    drawing: Drawing

    def scene(self) -> Scene:
        """The scene that the robust method fits in, every drawn pixel with the object's depth being kept."""
        frame, camera = self.frame, self.frame.camera
        segments = cut_sections(self.drawing.area, self.drawing.stroke, (camera.width, camera.height))
        depth_m = frame.depth_m.ravel()[segments.pixel].astype(np.float64)
        exact = self.surface.trace(camera.unproject(_places(segments.pixel, camera), np.ones(segments.pixel.size)).T)
        near = np.abs(depth_m - exact.depth_m.reshape(depth_m.shape)) < 0.3 * self.surface.size_m
        kept = segments.inside & exact.hit.reshape(depth_m.shape) & near
        return scene_of(camera, patch_of(frame, self.drawing.area, segments, kept), segments, kept, depth_m)

    def fit_from(self, scene: Scene, surface: Surface) -> RayFit:
        """A fit that ends where it is told to."""
        free = np.ones(len(surface.units(1.0)), dtype=bool)
        fit = fine(surface, scene.patch, surface.units(scene.length_m), free, Sight())
        assert fit is not None
        return replace(fit, surface=surface)


def _places(pixel: np.ndarray, camera: PinholeCamera) -> Floats:
    row, column = np.divmod(pixel.ravel(), camera.width)
    return np.stack([column, row], axis=-1).astype(np.float64)


def pair(
    shape: Frustum | Sphere = LEG,
    texture: Texture = "fine",
    seed: int = 0,
    baselines_m: tuple[float, ...] = (0.0, BASELINE_M),
    T_base_camera: Floats | None = None,
) -> Pair:
    """An object at 0.4 m, tilted by up to 20 degrees, before a wall."""
    rng = np.random.default_rng([seed, 31])
    turn, tilt = rng.uniform(0, np.pi), rng.uniform(-0.35, 0.35)
    axis = np.array([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)])
    T_camera_body = np.eye(4)
    T_camera_body[:3, 3] = rng.uniform([-0.01, -0.01, 0.38], [0.01, 0.01, 0.42])
    T_camera_body[:3, :3] = turn_of(axis, -T_camera_body[:3, 3]).T
    base = np.eye(4) if T_base_camera is None else T_base_camera
    solid = shape.moved(T_camera_body)
    wall = plane_behind(CAMERA, np.eye(4), np.array([0.0, 0.0, -1.0]), 0.75, concrete(rng))
    light = np.array([0.3, -0.6, -0.7]) / np.linalg.norm([0.3, -0.6, -0.7])
    world = World((Body(shape, T_camera_body, textured(texture, shape)(rng)), wall), light)
    views: list[View] = []
    for baseline_m in baselines_m:
        place = np.eye(4)
        place[0, 3] = baseline_m
        picture = render(world, CAMERA, place, supersampling=3).image
        noisy = np.rint(picture + rng.normal(0, NOISE_LEVELS, picture.shape)).clip(0, 255).astype(np.uint8)
        views.append(View(noisy, CAMERA, base @ place))
    disparity = CAMERA.focal_px * BASELINE_M / render(world, CAMERA, np.eye(4), supersampling=0).depth_m
    depth_m = CAMERA.focal_px * BASELINE_M / (disparity + 0.2 * rng.standard_normal(disparity.shape))
    noise = StereoNoise(BASELINE_M, 0.2)
    frame = Frame(views[0].image, CAMERA.cloud(depth_m), CAMERA, base, noise, views=tuple(views))
    return Pair(frame, surface_of(solid), ideal_drawing(solid, CAMERA))


def surface_of(solid: Frustum | Sphere) -> Surface:
    """The surface of a solid in camera coordinates."""
    if isinstance(solid, Sphere):
        return Ball(solid.center_m, solid.radius_m, CAMERA.focal_px)
    turn = turn_of(solid.direction, -solid.center_m)
    slope = float(np.tan(solid.half_angle_rad))
    return Lateral(solid.center_m, turn, solid.radius_m, slope, CAMERA.focal_px, tapers=solid.kind == "cone")


def painted(surface: Surface, camera: PinholeCamera, T_view_reference: Floats) -> Floats:
    """Grey values (H, W) of a smooth pattern that is fixed to a surface, without noise, blur or rounding.

    What is beside the surface continues it.
    """
    v, u = np.indices((camera.height, camera.width)).reshape(2, -1)
    rays = camera.unproject(np.stack([u, v], axis=-1), np.ones(u.size)).T
    center = transform(T_view_reference, surface.center_m)
    turned = {"turn": surface.turn @ T_view_reference[:3, :3].T} if isinstance(surface, Lateral) else {}
    depth_m = replace(surface, center_m=center, **turned).trace(rays).depth_m
    x, y, z = T_view_reference[:3, :3].T @ (rays * depth_m - T_view_reference[:3, 3:])
    grey = 120 + 40 * np.sin(190 * x + 60 * y) + 30 * np.sin(80 * x - 170 * y + 50 * z) + 25 * np.cos(120 * y + 150 * z)
    return grey.reshape(camera.height, camera.width)
