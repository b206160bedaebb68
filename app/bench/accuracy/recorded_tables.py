"""The tables of recorded scenes: sizes beside what is known, a margin at the limbs, and careless drawings."""

from dataclasses import replace
from pathlib import Path

from app.bench.accuracy.goals import Goal, mark, number
from app.bench.accuracy.misdrawn import MISTAKES, moved_by_mistakes
from app.bench.accuracy.recorded import (
    PR2_MUG,
    PR2_MUG_BODY,
    PR2_MUG_MARGIN,
    RECORDINGS,
    Answer,
    read_recording,
    said_of,
)
from app.bench.table import NONE, table
from app.drawing_text import parse_area
from rotrecon.frame import Frame
from rotrecon.settings import Method, Settings


def recorded_tables(folder: Path, method: Method) -> tuple[str, list[Goal]]:
    """All recorded scenes of a folder; raises SceneError for one that is missing."""
    frames = {recording.name: read_recording(recording, folder) for recording in RECORDINGS}
    sizes, goals = _sizes(frames, method)
    margin, goal = _margin(frames[PR2_MUG.name], method)
    text = f"""{sizes}

The mug with its area drawn from limb to limb, and 10 px narrower at both:

{margin}

The same mistakes in drawing as above; the change of the diameter in half widths of its interval, and in percent:

{_misdrawn(frames, method)}"""
    return text, [*goals, goal]


def _sizes(frames: dict[str, Frame], method: Method) -> tuple[str, list[Goal]]:
    rows: list[tuple[str, ...]] = []
    goals: list[Goal] = []
    for recording in RECORDINGS:
        said = said_of(frames[recording.name], recording.drawing, method)
        paper = said_of(frames[recording.name], recording.drawing, "paper")
        met = said["kind"] is not None and recording.agrees(said)
        rows.append((recording.name, recording.known, *_in_words(said), mark(met), *_in_words(paper)[:2]))
        goals.append(Goal(f"recorded: {recording.name}", ", ".join(_in_words(said)[:4]), recording.known, met))
    header = ("scene", "known", "kind", "diameter, mm", "95 %", "half angle, deg", "certain", "agrees")
    return table((*header, "paper: kind", "diameter, mm"), rows), goals


def _margin(frame: Frame, method: Method) -> tuple[str, Goal]:
    areas = {"as drawn": PR2_MUG.area, "limb to limb": PR2_MUG_BODY, "10 px less": PR2_MUG_MARGIN}
    said = {
        name: said_of(frame, replace(PR2_MUG.drawing, area=parse_area(area)), method) for name, area in areas.items()
    }
    rows = [(name, *_in_words(answer)) for name, answer in said.items()]
    intervals = [answer["interval_mm"] for answer in said.values()]
    met = all(interval is not None for interval in intervals) and (
        max(low for low, _ in intervals) <= min(high for _, high in intervals)
    )
    words = " and ".join(_in_words(answer)[2] for answer in said.values())
    goal = Goal("recorded: pr2_mug with a margin at the limbs", words, "intervals agree", met)
    return table(("area", "kind", "diameter, mm", "95 %", "half angle, deg", "certain"), rows), goal


def _misdrawn(frames: dict[str, Frame], method: Method) -> str:
    rows: list[tuple[str, ...]] = []
    for recording in RECORDINGS:
        moved = moved_by_mistakes(
            frames[recording.name], recording.drawing, recording.width_px, Settings(method=method)
        )
        cells = [f"{number(half)} ({number(100 * relative)} %)" for half, relative in moved.values()]
        rows.append((recording.name, *cells))
    return table(("scene", *MISTAKES), rows)


def _in_words(said: Answer) -> tuple[str, str, str, str, str]:
    """Kind, diameter, interval, half angle, certain; a refusal has none but its kind."""
    if said["kind"] is None:
        return "refused", NONE, NONE, NONE, NONE
    interval, angle = said["interval_mm"], said["half_angle_deg"]
    kind = f"{said['kind']}, concave" if said["concave"] else said["kind"]
    return (
        kind,
        f"{said['diameter_mm']:.1f}",
        NONE if interval is None else f"{interval[0]:.1f} to {interval[1]:.1f}",
        NONE if angle is None else f"{abs(angle):.1f}",
        mark(said["certain"]),
    )
