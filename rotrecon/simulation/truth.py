"""A simulated scene on disk: the scene folder, and what is true of it beside it."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from rotrecon.primitives import Frustum
from rotrecon.scene.writing import SceneRecord, write_scene
from rotrecon.simulation.ideal_drawing import as_arguments
from rotrecon.simulation.simulate import Simulated

TRUTH_FILE = "truth.json"


def write_simulated(folder: Path, simulated: Simulated) -> None:
    """Write the frame as a scene folder, with `truth.json` beside it; raises SceneError as `write_scene` does."""
    name = f"{simulated.object_name}, simulated with seed {simulated.seed}"
    truth = json.dumps(truth_table(simulated), indent=2, allow_nan=False) + "\n"
    write_scene(folder, SceneRecord(name, simulated.frame, "rotrecon simulate"), {TRUTH_FILE: truth.encode()})


def truth_table(simulated: Simulated) -> dict[str, Any]:
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
