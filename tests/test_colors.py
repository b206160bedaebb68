"""Colours that tell things apart do so for people who see no red, no green or no blue: computed, not judged by eye."""

import re
from itertools import combinations

import cv2
import numpy as np
import pytest

from app import scene_view
from app.camera_view import AREA_COLOR, AXIS_COLOR
from app.charts import EXCLUDED, LIT, MISSING, ODD, USED
from app.envelope_view import TOOL_COLOR
from app.pictures import BACK_COLOR, GONE_COLOR, KEPT_COLOR, RULER_COLOR, SECTION_COLOR
from app.scene_view import FRUSTUM_COLOR, LIMITS_COLOR, OBJECT_COLOR
from app.static_files import static_text
from rotrecon.grasp_overlay import HIT_COLOR, MOUTH_COLOR, STEEL_COLOR, WAY_COLOR
from rotrecon.overlay import LATER_RUN, LIGHT_BLUE, NAVY, OUTLINE_COLOR, RED, YELLOW
from rotrecon.residuals import BEFORE, BEHIND, BETWEEN

Color = tuple[int, int, int]
SEEN_BY = {
    "most people": np.eye(3),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "tritanopia": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
    ),
}
"""What becomes of linear RGB: Machado, Oliveira and Fernandes, A Physiologically-based Model for Simulation of Color
Vision Deficiency, IEEE TVCG 15 (6), 2009, table of matrices, severity 1.0."""
LEAST = 6 * 2.3
"""CIE 1976 colour difference: six times the 2.3 that can just be told apart side by side (Mahy, Van Eycken and
Oosterlinck, Color Research & Application 19 (2), 1994), as marks are small, and apart from each other."""


def from_hex(text: str) -> Color:
    return tuple(bytes.fromhex(text.removeprefix("#")))  # type: ignore[return-value]


def bar_of(rule: str) -> Color:
    """The colour of the bar beside a text of a class of the style sheet, the last that is said."""
    blocks = re.findall(rf"\{rule}\b[^{{}}]*\{{([^}}]*)\}}", static_text("console.css"))
    return from_hex(re.findall(r"border-left(?:-color)?:[^;#]*(#[0-9a-f]{6})", " ".join(blocks))[-1])


SETS: dict[str, dict[str, Color]] = {
    "segmentation": {
        "object": RED,
        "accepted": YELLOW,
        "close": LIGHT_BLUE,
        "distant": NAVY,
        "of a later run": LATER_RUN,
    },
    "dots of the radii": {name: from_hex(name) for name in (USED, ODD, EXCLUDED, MISSING)},
    "dots of a stage": {name: from_hex(name) for name in (USED, ODD, LIT, MISSING)},
    "pixels of a step": {"kept": KEPT_COLOR, "gone": GONE_COLOR, "back": BACK_COLOR},
    "residuals": {"behind": BEHIND, "between": BETWEEN, "before": BEFORE},
    "lines on the picture": {
        "area": AREA_COLOR,
        "axis": AXIS_COLOR,
        "outline": OUTLINE_COLOR,
        "ruler": RULER_COLOR,
        "tool": STEEL_COLOR,
        "mouth": MOUTH_COLOR,
    },
    "in the 3D view": {
        "object": OBJECT_COLOR,
        "axis": scene_view.AXIS_COLOR,
        "tool": TOOL_COLOR,
        "mouth": MOUTH_COLOR,
        "hit": HIT_COLOR,
        "section": scene_view.SECTION_COLOR,
        "limits": LIMITS_COLOR,
    },
    "pixels on the picture": {"hit": HIT_COLOR, "on the way": WAY_COLOR, "section": SECTION_COLOR},
    "states": {rule: bar_of(rule) for rule in (".rr-hint", ".rr-sure", ".rr-unsure", ".rr-armed", ".rr-out")},
}

BACKGROUNDS: dict[str, Color] = {"light": (255, 255, 255), "dark": (20, 20, 20)}
"""Of viser's 3D view: white, and the darkest grey of the palette that it is built with."""
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Of linear RGB."""
LEAST_CONTRAST = 3.0
"""Of what a person has to make out beside text: WCAG 2.1, 1.4.11."""


def linear_of(color: Color) -> np.ndarray:
    """Linear RGB of a colour of sRGB (IEC 61966-2-1)."""
    share = np.array(color) / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def lab(color: Color, seen: np.ndarray) -> np.ndarray:
    """CIELAB of a colour as it is seen."""
    linear = np.clip(seen @ linear_of(color), 0, 1)
    again = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return cv2.cvtColor(again.astype(np.float32)[None, None], cv2.COLOR_RGB2LAB)[0, 0]


@pytest.mark.parametrize("who", SEEN_BY)
@pytest.mark.parametrize("name", SETS)
def test_colors_that_mean_different_things_look_different(name: str, who: str) -> None:
    for (one, first), (other, second) in combinations(SETS[name].items(), 2):
        apart = float(np.linalg.norm(lab(first, SEEN_BY[who]) - lab(second, SEEN_BY[who])))
        assert apart >= LEAST, f"{one} and {other}: {apart:.1f}"


@pytest.mark.parametrize("page", BACKGROUNDS)
@pytest.mark.parametrize("name", [*SETS["in the 3D view"], "camera"])
def test_what_stands_in_the_3d_view_stands_out_from_a_light_page_and_a_dark_one(name: str, page: str) -> None:
    color = {**SETS["in the 3D view"], "camera": FRUSTUM_COLOR}[name]
    low, high = sorted(linear_of(one) @ LUMINANCE for one in (color, BACKGROUNDS[page]))
    assert (high + 0.05) / (low + 0.05) >= LEAST_CONTRAST


def test_the_simulation_confuses_what_is_confused_and_keeps_greys() -> None:
    """Red and green of one lightness are what the dichromat does not tell apart; grey stays grey."""
    red, green = (166, 108, 60), (124, 127, 60)
    apart = {who: float(np.linalg.norm(lab(red, seen) - lab(green, seen))) for who, seen in SEEN_BY.items()}
    assert apart["deuteranopia"] < apart["most people"] / 2
    for seen in SEEN_BY.values():
        assert np.allclose(seen @ np.ones(3), 1.0, atol=1e-5)
