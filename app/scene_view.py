"""The 3D scene in base coordinates, which all pages share: cloud, camera, limits, and the solid with its tool."""

import numpy as np
from numpy.typing import NDArray
from viser import ClientHandle, LineSegmentsHandle, SceneNodePointerEvent, ViserServer
from viser import transforms as tf

from app.envelope_view import TOOL_COLOR, EnvelopeView
from app.limit_lines import limit_lines
from app.page import SectionPointed
from app.panels import Post
from rotrecon.arrays import Bytes, Floats, Indices
from rotrecon.axis import SpaceSections
from rotrecon.camera import transform
from rotrecon.frame import Frame
from rotrecon.mesh import as_mesh
from rotrecon.primitives import Primitive
from rotrecon.reconstruction import Reconstruction
from rotrecon.residuals import Residuals
from rotrecon.tool_table import Tool
from rotrecon.tools import NoTool, ToolProposal

OBJECT_COLOR, SOLID_COLOR, AXIS_COLOR = (220, 40, 40), (86, 180, 233), (0, 132, 240)
SECTION_COLOR, LIMITS_COLOR, FRUSTUM_COLOR = (204, 121, 167), (144, 132, 72), (145, 145, 145)
OBJECT_POINTS = 10_000
"""As many of the segmented points as anybody can tell apart."""
SOLID_OPACITY, FAINT_OPACITY = 0.45, 0.1
"""Of the solid that was measured, and of one that another is on its way to replace."""


class SceneView:
    """Nodes under `/world`, named the same for as long as the program runs."""

    def __init__(self, server: ViserServer, frame: Frame, picture: Bytes, cloud_points: int, post: Post) -> None:
        self._scene, self._post, self._cloud_points = server.scene, post, cloud_points
        self._shown: Reconstruction | None = None
        self._tool: Tool | None = None
        self._limits: list[LineSegmentsHandle] = []
        self._scene.add_frame("/world", show_axes=False)
        self._marks = self._scene.add_frame("/world/marks", show_axes=False)
        """What stands at the solid: its axis and the tool."""
        self._show_solid(None)
        self._envelope = EnvelopeView(self._scene)
        self.hold(frame, picture)

    def hold(self, frame: Frame, picture: Bytes) -> None:
        """Show a frame, in the place of the one before it: its cloud, camera and limits."""
        self._frame = frame
        self._valid = np.isfinite(frame.depth_m).ravel()
        self._depth_m = float(np.median(frame.depth_m.ravel()[self._valid])) if self._valid.any() else 1.0
        self._add_cloud()
        self._add_camera(picture)
        size_m = 0.1 * self._depth_m
        self._scene.add_frame("/world/base", axes_length=size_m, axes_radius=size_m / 25)
        for limit in self._limits:
            limit.remove()
        self._limits = [
            self._scene.add_line_segments(
                f"/world/limits/{limit}", lines, LIMITS_COLOR, thickness=1.5, thickness_units="screen"
            )
            for limit, lines in limit_lines(frame.workspace, frame.camera, frame.T_base_camera).items()
        ]
        self._object = self._scene.add_point_cloud(
            "/world/object",
            np.zeros((1, 3)),
            OBJECT_COLOR,
            point_size=self._point_size_m() * 1.05,
            precision="float32",
            point_shading="flat",
            visible=False,
        )
        self._envelope.hold(frame, self._point_size_m())

    def show(self, result: Reconstruction | None, tool: Tool | None = None, *, faint: bool = False) -> None:
        """Show what was segmented, and the solid with its axis, contact point and approach, if there is one.

        A `tool` stands at its place, else the one that is proposed or may fit. Of a `faint` result, which another is on
        its way to replace, only a trace of the solid is left.
        """
        self._show_result(result, tool)
        self._object.visible = result is not None and not faint
        self._marks.visible = not faint
        self._solid.opacity = FAINT_OPACITY if faint else SOLID_OPACITY

    def _show_result(self, result: Reconstruction | None, tool: Tool | None) -> None:
        if self._tool != tool or self._shown is not result:
            self._tool = tool
            self._envelope.show(result, tool)
        if result is self._shown:
            return
        self._shown = result
        if result is not None:
            pixel = result.segments.pixel[result.segmentation.kept]
            pixel = pixel[:: max(1, -(-len(pixel) // OBJECT_POINTS))]
            self._object.points = self._in_base(pixel).astype(np.float32)
        solid = None if result is None else result.solid
        self._show_solid(solid)
        self._show_tool(None if result is None else result.tool, solid)

    def light_section(self, client: ClientHandle, result: Reconstruction | None, section: int) -> None:
        """Light one section on one page."""
        sections = None if result is None else result.sections
        points_m = np.zeros((1, 3)) if sections is None else self._section_points(sections, section)
        client.scene.add_point_cloud(
            "/section",
            points_m,
            SECTION_COLOR,
            point_size=self._point_size_m() * 1.7,
            precision="float32",
            point_shading="flat",
            visible=sections is not None,
        )

    def color_residuals(self, client: ClientHandle, residuals: Residuals | None) -> None:
        """Show on one page how far the object's points lie off the solid, in place of those that all pages see."""
        hidden = client.scene.get_handle_by_name("/world/object")
        if residuals is not None and hidden is None:
            client.scene.add_frame("/world/object", show_axes=False, visible=False)
        elif residuals is None and hidden is not None:
            hidden.remove()
        chosen = slice(0) if residuals is None else slice(None, None, -(-len(residuals.pixel) // OBJECT_POINTS))
        points_m = np.zeros((1, 3)) if residuals is None else self._in_base(residuals.pixel[chosen])
        client.scene.add_point_cloud(
            "/residuals",
            points_m,
            OBJECT_COLOR if residuals is None else residuals.colors[chosen],
            point_size=1.5 * self._point_size_m() / self._stride,
            precision="float32",
            point_shading="flat",
            visible=residuals is not None,
        )

    def hide_own(self, client: ClientHandle) -> None:
        """Take away what one page has of its own, as it would hide the picture in the camera view."""
        for name in ("/section", "/residuals"):
            node = client.scene.get_handle_by_name(name)
            if node is not None:
                node.visible = False

    def look(self, client: ClientHandle, pose: tuple[Floats, ...] | None) -> None:
        """Stand where the page stood last (up, position, look-at), or beside the sensor and above it."""
        T, far, camera = self._frame.T_base_camera, self._depth_m, client.camera
        right, down, forward = T[:3, 0], T[:3, 1], T[:3, 2]
        beside = T[:3, 3] - far * (0.25 * forward + 0.35 * down - 0.45 * right)
        up, position, look_at = pose or (self._up(), beside, T[:3, 3] + far * forward)
        with client.atomic():
            camera.max_orbit_distance = 1e4
            camera.min_orbit_distance = 0.01
            camera.fov = float(np.deg2rad(50))
            camera.up_direction = up
            camera.position = position
            camera.look_at = look_at

    def _up(self) -> Floats:
        """Up in base coordinates; of a base that is the camera itself, up in the picture."""
        is_camera = np.allclose(self._frame.T_base_camera, np.eye(4))
        return np.array([0.0, -1.0, 0.0]) if is_camera else np.array([0.0, 0.0, 1.0])

    def _in_base(self, pixel: Indices | NDArray[np.int64]) -> Floats:
        return transform(self._frame.T_base_camera, self._frame.points_m.reshape(-1, 3)[pixel])

    def _section_points(self, sections: SpaceSections, section: int) -> Floats:
        points_m = sections.points_in(section)
        return transform(self._frame.T_base_camera, points_m) if len(points_m) else np.zeros((1, 3))

    def _point_size_m(self) -> float:
        """Points as large as they are apart."""
        return 1.5 * self._depth_m / self._frame.camera.focal_px * self._stride

    def _add_cloud(self) -> None:
        """Every n-th point of the cloud both ways, so that about as many are sent as were asked for."""
        self._stride = max(1, round(float(np.sqrt(self._valid.sum() / max(self._cloud_points, 1)))))
        number = np.arange(self._valid.size).reshape(self._frame.depth_m.shape)[:: self._stride, :: self._stride]
        chosen = number[self._valid.reshape(self._frame.depth_m.shape)[:: self._stride, :: self._stride]]
        self._scene.add_point_cloud(
            "/world/cloud",
            self._in_base(chosen),
            self._frame.image.reshape(-1, 3)[chosen],
            point_size=self._point_size_m(),
            precision="float32",
            point_shading="flat",
        )

    def _add_camera(self, picture: Bytes) -> None:
        camera, T = self._frame.camera, self._frame.T_base_camera
        self._scene.add_camera_frustum(
            "/world/camera",
            fov=float(2 * np.arctan(camera.height / 2 / camera.K[1, 1])),
            aspect=camera.width / camera.height,
            scale=0.08 * self._depth_m,
            thickness=1.5,
            thickness_units="screen",
            color=FRUSTUM_COLOR,
            image=picture,
            format="jpeg",
            wxyz=tf.SO3.from_matrix(T[:3, :3]).wxyz,
            position=T[:3, 3],
            cast_shadow=False,
            receive_shadow=False,
        )

    def _show_solid(self, solid: Primitive | None) -> None:
        mesh = None if solid is None else as_mesh(solid)
        self._solid = self._scene.add_mesh_simple(
            "/world/solid",
            np.zeros((3, 3)) if mesh is None else np.asarray(mesh.vertices),
            np.array([[0, 1, 2]]) if mesh is None else np.asarray(mesh.faces),
            color=SOLID_COLOR,
            opacity=SOLID_OPACITY,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
            visible=mesh is not None,
        )
        self._solid.on_click(self._clicked)
        ends = np.zeros((1, 2, 3))
        if solid is not None:
            overhang = 1.3 * np.array(solid.ends)[:, None]
            ends = (solid.center_m + overhang * solid.direction)[None]
        self._scene.add_line_segments(
            "/world/marks/axis", ends, AXIS_COLOR, thickness=3.0, thickness_units="screen", visible=solid is not None
        )

    async def _clicked(self, event: SceneNodePointerEvent) -> None:
        self._post(event.client_id, SectionPointed(event.ray_origin, event.ray_direction))

    def _show_tool(self, tool: ToolProposal | NoTool | None, solid: Primitive | None) -> None:
        length_m = 0.15 * self._depth_m
        proposal = tool if isinstance(tool, ToolProposal) and solid is not None else None
        contact_m = np.zeros(3) if proposal is None else proposal.contact_point_m
        approach = np.array([0.0, 0.0, 1.0]) if proposal is None else proposal.approach
        self._scene.add_arrows(
            "/world/marks/approach",
            np.array([[contact_m - length_m * approach, contact_m]]),
            TOOL_COLOR,
            shaft_radius=length_m / 40,
            head_radius=length_m / 14,
            head_length=length_m / 5,
            visible=proposal is not None,
        )
        self._scene.add_icosphere(
            "/world/marks/contact",
            length_m / 20,
            TOOL_COLOR,
            position=contact_m,
            cast_shadow=False,
            visible=proposal is not None,
        )
