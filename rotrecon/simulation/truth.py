"""A simulated scene on disk: the scene folder, and what is true of it beside it."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from rotrecon.primitives import Frustum
from rotrecon.scene.view_writing import ViewsRecord, write_views
from rotrecon.scene.writing import SceneRecord, write_scene
from rotrecon.simulation.ideal_drawing import as_arguments
from rotrecon.simulation.simulate import Simulated
from rotrecon.simulation.stereo import SimulatedViews

TRUTH_FILE = "truth.json"


def write_simulated(folder: Path, simulated: Simulated | SimulatedViews) -> None:
    """Write the frame or the views as a scene folder, with `truth.json` beside; raises SceneError as `write_scene`."""
    name = f"{simulated.object_name}, simulated with seed {simulated.seed}"
    table = truth_table(simulated)
    if isinstance(simulated, SimulatedViews):
        table |= _views_table(simulated)
    beside = {TRUTH_FILE: (json.dumps(table, indent=2, allow_nan=False) + "\n").encode()}
    if isinstance(simulated, SimulatedViews):
        write_views(folder, ViewsRecord(name, simulated.recorded, "rotrecon simulate"), beside)
    else:
        write_scene(folder, SceneRecord(name, simulated.frame, "rotrecon simulate"), beside)


def _views_table(simulated: SimulatedViews) -> dict[str, Any]:
    """What is wrong with the views, and their true cameras."""
    views = [
        {"K": lens.camera.K.tolist(), "distortion": lens.distortion.tolist(), "T_base_camera": pose.tolist()}
        for lens, pose in zip(simulated.true_lenses, simulated.true_poses, strict=True)
    ]
    return {"texture": simulated.texture, "flaws": asdict(simulated.flaws), "views": views}


def truth_table(simulated: Simulated | SimulatedViews) -> dict[str, Any]:
    """What is true of a simulated scene, in base coordinates; `area` and `axis` are arguments of `rotrecon fit`.

    A ball has neither axis nor half angle: they are null, and its length is its diameter.
    """
    solid = simulated.solid
    frustum = solid if isinstance(solid, Frustum) else None
    area, axis = as_arguments(simulated.drawing)
    return {
        "object": simulated.object_name,
        "seed": simulated.seed,
        "kind": solid.kind,
        "diameter_mm": simulated.diameter_mm,
        "length_mm": 1000 * float(np.ptp(solid.ends)),
        "half_angle_deg": None if frustum is None else float(np.rad2deg(frustum.half_angle_rad)),
        "center_m": solid.center_m.tolist(),
        "direction": None if frustum is None else frustum.direction.tolist(),
        "frame": "base",
        "area": area,
        "axis": axis,
    }
