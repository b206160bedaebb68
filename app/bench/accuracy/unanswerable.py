"""Areas for which there is no certain answer: simulated, and chosen by hand in the recordings."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from app.bench.accuracy.recorded import RECORDINGS, read_recording
from app.drawing_text import parse_area, parse_axis
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame
from rotrecon.simulation.arrangements.boxy import BOXY
from rotrecon.simulation.arrangements.cluttered import CLUTTERED, EMPTY
from rotrecon.simulation.arrangements.flat import FLAT
from rotrecon.simulation.distractors import SMALL_CAMERA, WHITE, distractor
from rotrecon.simulation.simulate import DEFAULT_CAMERA
from rotrecon.simulation.stereo_noise import StereoErrors

SIMULATED = "simulated"
GROUPS = {"flat": FLAT, "boxy": BOXY, "cluttered": CLUTTERED, "empty": EMPTY}
HOW_MANY = {
    "wall": 4, "table": 5, "plank": 4, "bumpy": 6, "roof": 6,
    "outside corner": 6, "inside corner": 6, "step": 5, "staircase": 4,
    "face on": 6, "edge on": 12, "corner on": 8, "any box": 12, "square bar": 12, "flat bar": 8,
    "three-sided bar": 6, "six-sided bar": 6, "pyramid": 6, "oval bar": 8, "egg": 5,
    "two rods": 6, "crossing rods": 5, "handle": 6, "half hidden": 5, "heap": 6,
    "background": 3, "hole": 2, "few pixels": 6, "false matches": 3,
}  # fmt: skip
"""Seeds of each kind of simulated scene."""
ERRORS = (None, WHITE, StereoErrors())

RECORDED = {
    "tin": {
        "table": ("120,300 220,380", "130,340 210,340"),
        "table toward the camera": ("430,250 520,420", "475,260 475,410"),
        "all of the table": ("120,250 600,460", "200,355 560,355"),
        "table in a slanted area": ("400,300 560,230 600,320 440,400", "420,350 580,275"),
        "gap between two boards": ("380,190 560,290", "400,200 545,280"),
        "table, a long strip": ("120,420 620,440", "130,430 610,430"),
        "table, a strip into depth": ("500,130 520,470", "510,140 510,460"),
        "far end of the depth": ("120,130 250,190", "130,165 240,165"),
        "far end and beyond": ("400,100 630,150", "410,130 620,120"),
        "left end of the depth": ("40,250 120,330", "80,260 80,320"),
        "lid": ("295,66 352,84", "300,75 348,75"),
        "foot, and the table before it": ("250,195 400,260", "270,238 385,238"),
        "left limb, and the table": ("240,150 305,260", "265,160 265,250"),
        "right limb, and the table": ("350,140 420,250", "385,150 385,240"),
        "no depth": ("20,20 120,60", "30,40 110,40"),
    },
    "blue_mug": {
        "table": ("110,220 210,330", "160,230 160,320"),
        "table before the mug": ("250,350 420,460", "335,360 335,450"),
        "table, sideways": ("150,360 550,450", "170,405 530,405"),
        "table, slanted stroke": ("450,200 620,330", "470,220 600,310"),
        "gap between two boards": ("430,240 560,350", "440,250 550,340"),
        "far end of the depth": ("80,120 220,185", "90,165 210,165"),
        "left end of the depth": ("50,140 110,260", "80,150 80,250"),
        "handle": ("378,190 430,300", "400,205 400,285"),
        "bend of the handle": ("385,192 428,245", "390,200 418,235"),
        "handle, body and what is between": ("362,215 400,270", "381,220 381,265"),
        "foot, and the table before it": ("260,300 400,370", "270,345 390,345"),
        "left limb, and the table": ("230,190 292,330", "245,200 262,320"),
        "no depth": ("100,20 300,100", "110,60 290,60"),
    },
    "green_bowl": {
        "table": ("110,220 200,330", "155,230 155,320"),
        "table, sideways": ("200,350 480,460", "210,405 470,405"),
        "table, slanted stroke": ("460,180 620,260", "470,250 610,190"),
        "gap between two boards": ("440,240 560,340", "450,250 550,330"),
        "table, a long strip": ("120,420 600,436", "130,428 590,428"),
        "far end of the depth": ("80,120 200,190", "90,165 190,165"),
        "left end of the depth": ("60,200 120,330", "90,210 90,320"),
        "foot, and the table before it": ("270,312 400,370", "280,350 390,350"),
        "left limb, and the table": ("190,200 262,310", "200,215 240,305"),
        "right limb, and the table": ("410,255 470,330", "450,260 425,325"),
        "no depth": ("320,20 600,90", "330,55 590,55"),
    },
    "pr2_mug": {
        "table": ("160,220 290,330", "225,230 225,320"),
        "table, sideways": ("160,390 320,460", "170,425 310,425"),
        "table, slanted stroke": ("500,220 610,330", "510,230 600,320"),
        "table, near": ("500,380 610,450", "555,385 555,445"),
        "all of the table": ("145,385 620,465", "160,425 600,425"),
        "wall": ("400,40 480,140", "440,50 440,130"),
        "wall, sideways": ("320,30 600,150", "330,90 590,90"),
        "table's far edge": ("450,140 600,220", "460,180 590,180"),
        "from the table to the wall": ("480,120 580,230", "530,125 530,225"),
        "handle": ("445,272 500,365", "470,285 470,355"),
        "top of the handle": ("440,270 500,310", "450,283 490,295"),
        "bottom of the handle": ("440,325 500,365", "445,350 488,340"),
        "foot, and the table before it": ("340,365 440,430", "350,405 430,405"),
        "left limb, and the table": ("300,270 352,380", "320,280 325,370"),
        "no depth": ("10,100 120,300", "60,110 60,290"),
    },
    "ros1_can": {
        "wall": ("220,40 350,110", "230,75 340,75"),
        "wall, left": ("40,110 120,190", "80,115 80,185"),
        "wall, right": ("440,80 510,180", "475,85 475,175"),
        "wall and floor": ("100,200 300,290", "110,245 290,240"),
        "wall and floor, right": ("350,200 500,280", "360,237 490,230"),
        "from the floor up the wall": ("380,180 480,300", "430,190 430,290"),
        "floor": ("60,320 200,440", "70,380 190,380"),
        "floor toward the camera": ("330,330 480,440", "405,340 405,430"),
        "all of the floor": ("100,390 560,450", "110,420 550,420"),
        "floor, slanted stroke": ("380,290 560,400", "390,300 550,390"),
        "top of the can": ("266,283 300,297", "270,290 297,290"),
        "foot, and the floor before it": ("250,345 330,410", "260,385 320,385"),
        "right limb, and the floor": ("295,280 360,370", "325,290 325,360"),
        "left limb, and the floor": ("215,285 276,370", "240,295 245,360"),
        "right end of the depth": ("480,220 580,300", "500,235 570,290"),
        "no depth": ("540,60 630,200", "585,70 585,190"),
    },
    "concrete_pipe": {
        "plug": ("410,210 540,330", "475,220 475,320"),
        "plug, sideways": ("410,210 540,330", "420,270 530,270"),
        "plug, small": ("430,230 520,300", "440,240 510,290"),
        "spots at the upper left": ("5,5 300,200", "20,100 290,100"),
        "spots at the lower left": ("5,200 300,470", "150,210 150,460"),
        "spots at the upper right": ("600,10 840,140", "610,75 830,75"),
    },
}
"""Rectangles or polygons, and strokes, px: nothing round in them but a limb or a foot beside the stroke."""


@dataclass(frozen=True)
class Area:
    """One area that is not to be answered with certainty."""

    source: str
    """A recording, or `SIMULATED`."""
    kind: str
    seed: int = 0

    def __str__(self) -> str:
        return f"{self.source}: {self.kind}" + (f" {self.seed}" if self.source == SIMULATED else "")

    @property
    def group(self) -> str:
        """What there is instead of something round."""
        groups = (name for name, makers in GROUPS.items() if self.kind in makers)
        return next(groups) if self.source == SIMULATED else "recorded"

    def load(self, recordings: Path) -> tuple[Frame, Drawing]:
        """Its frame, from a folder of recordings if it is of one, and its drawing; SceneError for one that is missing.

        Simulated depth is exact, with white noise and matched in turn.
        """
        if self.source != SIMULATED:
            area, axis = RECORDED[self.source][self.kind]
            return _recorded(self.source, recordings), Drawing(parse_area(area), parse_axis(axis))
        camera = DEFAULT_CAMERA if self.seed % 6 == 5 else SMALL_CAMERA
        scene = distractor(self.kind, self.seed, ERRORS[self.seed % 3], camera, picture=self.seed % 4 in (1, 2))
        return scene.frame, scene.drawing


AREAS = tuple(
    [Area(SIMULATED, kind, seed) for kind, count in HOW_MANY.items() for seed in range(count)]
    + [Area(source, kind) for source, areas in RECORDED.items() for kind in areas]
)


@cache
def _recorded(name: str, recordings: Path) -> Frame:
    return read_recording(next(one for one in RECORDINGS if one.name == name), recordings)
