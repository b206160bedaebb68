"""Where does this number come from: the page's texts are walked, and each number in them has to say it."""

import re
from contextlib import closing
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import msgspec
import pytest

from app.deciding.events import ControlAsked
from app.decision_text import control_html, decision_html
from app.held import Held
from app.history_text import entry_html, head_html, list_html
from app.inspection import line_in, residuals_in
from app.inspection_panel import step_html
from app.inspection_text import candidates_html, distance_html, residuals_html
from app.origins import field_named, origins, origins_html
from app.page_panels import depth_bar, section_html
from app.record.entries import Entry
from app.record.evidence import proposal
from app.record.history import History, Wanted
from app.record.store import Record
from app.result_text import hint_html, result_html, why_html
from app.session import Measured, Session
from app.tool_text import next_view_html, place_html, tools_html
from app.wording import rests_on
from rotrecon.capture import Capture
from rotrecon.contact import Place
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Method, Settings
from rotrecon.simulation.simulate import simulate
from rotrecon.workspace import Workspace
from tests.deciding.desk import ANN, BOB, Table

VOID = {"br", "img", "circle", "path", "line"}


class Walk(HTMLParser):
    """Numbers in a text that belong to no element that says where they come from, and the fields that are named."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.unexplained: list[str] = []
        self.fields: set[str] = set()
        self._open: list[bool] = []
        self.feed(html)
        self.close()
        assert not self._open, f"left open in {html}"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        said = dict(attrs)
        named = (said.get("data-from") or "").split()
        self.fields |= {*named, *filter(None, [said.get("data-field")])}
        assert bool(named) == bool(said.get("title")), "what is pointed at says it in words"
        if tag not in VOID:
            self._open.append(bool(named))

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            self._open.pop()

    def handle_data(self, data: str) -> None:
        if re.search(r"\d", data) and not any(self._open):
            self.unexplained.append(data)


def measured(method: Method, kind: str, **changes: object) -> Reconstruction:
    scene = simulate(kind, 0)
    drawing = replace(scene.drawing, contact=Place(0.3, 0.02))
    frame = replace(scene.frame, **changes)
    (cutter, clipper, grip) = Settings().tools
    limited = msgspec.structs.replace(cutter, diameter_mm=(10.0, scene.diameter_mm))
    return reconstruct(frame, drawing, Settings(method=method, layers=3, tools=(limited, clipper, grip)))


def texts(result: Reconstruction, folder: Path) -> dict[str, str]:
    """All that the page says of a result, while it is armed and another page asks for control."""
    camera = result.frame.camera
    table = Table()
    table.arm()
    held = Held(result.frame, "a leg", Capture("a leg", recorded=result.frame), entry=12)
    table.do(ControlAsked(table.later(1.0), BOB))
    session = Session((camera.width, camera.height), measured=Measured(0, result), decision=table.deciding, held=held)
    with closing(Record.open(folder)) as record:
        written = record.append(proposal("Ann", result.frame, result.drawing, result.settings, result), result.frame)
        record.append(Entry("rejected", "Ann", written.content["digest"], {"reason": "thicker than 30 mm"}))
        listing = History(record).listing(Wanted(chosen=2))
    section = len(result.segments.pixel) // 2
    return {
        "hint": hint_html(session),
        "result": result_html(session),
        "why": why_html(session),
        "tools": tools_html(result),
        "place": place_html(result),
        "next view": next_view_html(result),
        "candidates": candidates_html(result),
        "residuals": residuals_html(residuals_in(result)),
        "distance": distance_html(result.frame, True, ((60.0, 100.0), (250.0, 100.0))),
        "section": section_html(result, section),
        "step": "".join(step_html(line_in(result, section), number) for number in range(7)),
        "decision": decision_html(session),
        "control": control_html(table.deciding, ANN),
        "depths": depth_bar((0.5, 1.5)),
        "list": list_html(listing, None),
        "entry": entry_html(listing.chosen, "3 of 20 numbers are not the same", False),
        "head": head_html(listing.head),
    }


@pytest.mark.parametrize(
    "result",
    [
        measured("robust", "leg"),
        measured("paper", "leg"),
        measured("robust", "cone", workspace=Workspace(reach_m=(0.0, 1.0))),
        measured("robust", "ball"),
    ],
    ids=["leg", "by the paper", "cone out of reach", "ball"],
)
def test_every_number_on_the_page_says_where_it_comes_from(result: Reconstruction, tmp_path: Path) -> None:
    shown = texts(result, tmp_path)
    for name, html in shown.items():
        walk = Walk(html)
        assert not walk.unexplained, name
        assert walk.fields <= set(origins()), name
    assert sum(bool(re.search(r"\d", re.sub("<[^>]*>", "", html))) for html in shown.values()) >= 14


def test_what_the_walk_does_not_let_pass() -> None:
    assert Walk("<div>12 mm</div>").unexplained == ["12 mm"]
    assert not Walk('<div data-from="rms_mm" title="it is">12 <b>mm</b></div>').unexplained


def test_every_origin_is_a_sentence_and_found_by_its_name() -> None:
    html = origins_html()
    assert html.count("<details") == len(origins())
    assert all(text.endswith(".") and len(text) > 20 for _, text in origins().values())
    assert all(field_named(name.upper()) == field for field, (name, _) in origins().items())


def test_what_an_interval_rests_on_is_explained_row_by_row() -> None:
    known = {
        "center_interval_mm": 1.0,
        "axis_interval_deg": 0.5,
        "inlier_share": 0.9,
        "sigma_over_radius": 0.01,
        "noise": {"sigma_mm": 2.0, "disparity_sigma_px": 0.2, "correlation_px": 5.0, "stated": True},
        "stereo": {"views": [1, 2], "epipolar_error_px": 0.1, "valid_share": 0.8, "left_out": ["view 3: blurred"]},
    }
    rows = rests_on(known)
    assert len(rows) == 11
    assert all(field_named(name) in origins() for name, _ in rows)
