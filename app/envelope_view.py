"""The tool at the object in the 3D scene: its mouth, jaws and body, and what of the cloud it would hit."""

import numpy as np
from viser import SceneApi

from app.inspection import grasp_in
from rotrecon.camera import transform
from rotrecon.envelope import Box
from rotrecon.frame import Frame
from rotrecon.grasp_overlay import HIT_COLOR, MOUTH_COLOR, edges_of
from rotrecon.reconstruction import Reconstruction
from rotrecon.tool_table import Tool

TOOL_COLOR = (204, 132, 0)
"""Darker than on the picture: it has to stand out from a white page and from a black one."""
STEEL_OPACITY, MOUTH_OPACITY = 0.55, 0.12
ENVELOPE = "/world/marks/envelope"
PARTS = ("left", "right", "body", "mouth")
NO_BOX = (np.zeros((3, 3)), np.array([[0, 1, 2]]))


class EnvelopeView:
    """Nodes under `ENVELOPE`, named the same for as long as the program runs."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene

    def hold(self, frame: Frame, point_size_m: float) -> None:
        """The frame whose points the tool would hit, and how large they are shown."""
        self._frame, self._point_size_m = frame, point_size_m

    def show(self, result: Reconstruction | None, tool: Tool | None = None) -> None:
        """Show a tool at its place, by default the one that is proposed or may fit; or hide it."""
        grasp = None if result is None else grasp_in(result, tool)
        boxes = (None,) * len(PARTS) if grasp is None else (*grasp.envelope.solid, grasp.envelope.mouth)
        for name, box in zip(PARTS, boxes, strict=True):
            self._show_box(name, box)
        pixel = np.zeros(0, dtype=np.int32) if grasp is None else grasp.at_contact.pixel
        hit_m = transform(self._frame.T_base_camera, self._frame.points_m.reshape(-1, 3)[pixel])
        self._scene.add_point_cloud(
            f"{ENVELOPE}/hit",
            hit_m if len(hit_m) else np.zeros((1, 3)),
            HIT_COLOR,
            point_size=2 * self._point_size_m,
            precision="float32",
            point_shading="flat",
            visible=len(hit_m) > 0,
        )

    def _show_box(self, name: str, box: Box | None) -> None:
        is_mouth = name == "mouth"
        color = MOUTH_COLOR if is_mouth else TOOL_COLOR
        mesh = None if box is None else box.as_mesh()
        vertices, faces = NO_BOX if mesh is None else (np.asarray(mesh.vertices), np.asarray(mesh.faces))
        self._scene.add_mesh_simple(
            f"{ENVELOPE}/{name}",
            vertices,
            faces,
            color=color,
            opacity=MOUTH_OPACITY if is_mouth else STEEL_OPACITY,
            flat_shading=True,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
            visible=box is not None,
        )
        self._scene.add_line_segments(
            f"{ENVELOPE}/{name} edges",
            np.zeros((1, 2, 3)) if box is None else edges_of(box),
            color,
            thickness=1.5,
            thickness_units="screen",
            visible=box is not None,
        )
