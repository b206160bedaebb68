"""What was recorded of a recording's tin: computed again to the last bit, and handed on in every format."""

import base64
import csv
import json
import re
from contextlib import closing
from dataclasses import replace
from html.parser import HTMLParser
from io import BytesIO, StringIO
from pathlib import Path
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest
import trimesh
from plyfile import PlyData

from app.digest import evidence_digest
from app.drawing_text import parse_area, parse_axis
from app.record.entries import Entry, Head, link
from app.record.errors import NoSuchEntry
from app.record.evidence import Decision, decision_of, evidence_of, proposal, replay
from app.record.store import Record
from app.report.chart import sections_svg
from app.report.exports import NothingToExport, export_decision, export_entry
from app.report.points import Label
from app.report.sections import COLUMNS
from rotrecon.camera import transform
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame
from rotrecon.outcome import FitFailure
from rotrecon.reconstruct import reconstruct
from rotrecon.scene.reading import read_scene
from rotrecon.settings import Settings
from tests.exact import CAMERA
from tests.recordings import recording

TIN = Drawing(parse_area("280,50 370,230"), excluded_sections=frozenset({5}))
WALL = Drawing(parse_area("60,60 260,190"), parse_axis("160,70 160,180"))
TURNED = np.array([[0.0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])
EVIL = '<img src="http://elsewhere.example/x"> & <script>alert(1)</script>'


def decided(folder: Path, frame: Frame, drawing: Drawing, settings: Settings) -> Decision:
    """A measurement that was recorded and confirmed, read from the disk again."""
    result = reconstruct(frame, drawing, settings)
    with closing(Record.open(folder)) as record:
        written = record.append(proposal("ann", frame, drawing, settings, result), frame)
        assert written.content["digest"] == evidence_digest(frame, drawing, settings, result)
        record.append(Entry("armed", "ann", written.content["digest"]))
        record.append(Entry("confirmed", EVIL, written.content["digest"], {"reason": EVIL}))
    with closing(Record.read(folder)) as record:
        return decision_of(record, 3)


@pytest.fixture(scope="module")
def tin(tmp_path_factory: pytest.TempPathFactory) -> Decision:
    frame = read_scene(recording("tin")).frame()
    assert isinstance(frame, Frame)
    return decided(tmp_path_factory.mktemp("tin"), replace(frame, T_base_camera=TURNED), TIN, Settings())


@pytest.fixture(scope="module")
def by_paper(tmp_path_factory: pytest.TempPathFactory) -> Decision:
    frame = read_scene(recording("tin")).frame()
    assert isinstance(frame, Frame)
    return decided(tmp_path_factory.mktemp("paper"), frame, TIN, Settings(method="paper"))


@pytest.fixture(scope="module")
def wall(tmp_path_factory: pytest.TempPathFactory) -> Decision:
    depth = np.random.default_rng(0).normal(1.0, 0.001, (240, 320))
    frame = Frame(np.full((240, 320, 3), 128, np.uint8), CAMERA.cloud(depth), CAMERA)
    return decided(tmp_path_factory.mktemp("wall"), frame, WALL, Settings())


@pytest.fixture(params=["tin", "by_paper", "wall"])
def decision(request: pytest.FixtureRequest) -> Decision:
    return request.getfixturevalue(request.param)


def test_every_number_is_the_same_when_it_is_computed_again(decision):
    assert decision.replay.differences == ()
    assert decision.replay.versions == ()
    assert decision.replay.same
    assert decision.replay.numbers > 40


def test_a_decision_is_about_the_proposal_of_its_digest(decision):
    assert [entry.content["kind"] for entry in decision.trail[1:]] == ["armed", "confirmed"]
    assert decision.evidence.entry.id == 1
    kind = "proposal" if decision.evidence.answer["tool"] else "refusal"
    assert decision.evidence.entry.content["kind"] == kind
    assert decision.head == decision.entry.head


def test_a_number_that_came_out_another_way_is_named(tin):
    tree = json.loads(json.dumps(tin.evidence.result))
    solid = tree["fit"]["Fit"]["solid"]["Frustum"]
    solid["radius_m"] = float(np.nextafter(solid["radius_m"], 1))
    tree["segmentation"]["Segmentation"]["kept"]["array"] = "0" * 64
    tree["fit"]["Fit"]["along_m"]["numbers"].append(1.0)
    again = replay(replace(tin.evidence, result=tree))
    assert not again.same
    count = len(tree["fit"]["Fit"]["along_m"]["numbers"]) - 1
    assert sorted(one.name for one in again.differences) == [
        f"fit.Fit.along_m.numbers[{count}]",
        "fit.Fit.solid.Frustum.radius_m",
        "segmentation.Segmentation.kept",
    ]
    page = export_decision(replace(tin, replay=again), "html").decode()
    assert 'data-field="differs"' in page


def test_an_entry_about_nothing_has_nothing_to_compute(tmp_path):
    with closing(Record.open(tmp_path)) as record:
        for digest in (None, "d" * 64):
            with pytest.raises(NoSuchEntry, match="about no measurement"):
                evidence_of(record, record.append(Entry("armed", "ann", digest)))


class Page(HTMLParser):
    """What is in a page: its tags, the addresses it names, and what its marked fields say."""

    VOID = ("meta", "img")

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.addresses: list[str] = []
        self.fields: dict[str, str] = {}
        self.open: list[tuple[str, str | None]] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        known = dict(attributes)
        self.tags.append(tag)
        self.addresses += [value or "" for name, value in attributes if name in ("src", "href", "srcset", "action")]
        if tag not in self.VOID:
            self.open.append((tag, known.get("data-field")))

    def handle_startendtag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop()[0] == tag

    def handle_data(self, data: str) -> None:
        for _, field in self.open:
            if field is not None:
                self.fields[field] = self.fields.get(field, "") + data


def test_the_report_is_one_page_that_needs_nothing_else(decision):
    text = export_decision(decision, "html").decode()
    page = Page(text)
    assert page.open == []
    assert not {"script", "link", "iframe", "a", "form"} & set(page.tags)
    assert len(page.addresses) == 3 + (decision.evidence.answer["tool"] is not None)
    for address in page.addresses:
        head, content = address.split(",")
        assert head == "data:image/jpeg;base64"
        picture = cv2.imdecode(np.frombuffer(base64.b64decode(content), np.uint8), cv2.IMREAD_COLOR)
        assert picture is not None
    assert "url(" not in text
    assert not re.search(r"https?://(?!elsewhere)", text)
    assert page.fields["who"] == EVIL
    assert page.fields["digest"] == decision.entry.content["digest"]
    assert page.fields["head"] == str(decision.head)


def test_the_report_says_the_recorded_numbers(tin):
    page = Page(export_decision(tin, "html").decode())
    assert page.fields["tool"] == "mechanical cutter"
    assert page.fields["result"].strip().startswith(f"cylinder, {tin.evidence.answer['diameter_mm']:.1f} ± ")
    assert "differs" not in page.fields
    assert page.tags.count("svg") == 2
    assert "overridden" not in page.fields
    assert "in-the-way" not in page.fields


def test_the_report_of_an_override_names_the_tool_that_was_chosen_and_the_one_that_was_not(tin):
    content = tin.entry.content
    said = {
        "tool": "clipper",
        "override": "the cutter is blunt",
        "in_the_way": "It would hit a pipe.",
        "seconds": 120.0,
    }
    head = Head(content["id"] - 1, content["previous"])
    chosen = link(Entry("overridden", "ann", content["digest"], said), head, content["versions"])
    text = export_decision(replace(tin, entry=chosen, trail=(*tin.trail[:2], chosen)), "html").decode()
    page = Page(text)
    assert page.fields["tool"] == "clipper"
    assert "answer was:\nmechanical cutter" in page.fields["overridden"]
    assert "the cutter is blunt" in page.fields["words"]
    assert "It would hit a pipe" in page.fields["words"]
    assert "good for 120 s" in page.fields["words"]
    assert "The clipper at its place" in text


def test_a_report_of_a_refusal_says_why(wall):
    text = export_decision(wall, "html").decode()
    assert "Nothing could be measured" in text
    assert isinstance(wall.replay.result.fit, FitFailure)
    assert wall.replay.result.fit.advice in text


def test_the_chart_shows_every_section_with_a_radius(tin):
    chart = ElementTree.fromstring(sections_svg(tin.replay.result))
    groups = {group.findtext("title"): len(group.findall("circle")) for group in chart.iter("g")}
    assert (groups["used"], groups["excluded"]) == (tin.evidence.answer["sections"]["used"], 1)
    assert len(list(chart.iter("polygon"))) == 1
    numbers = [float(text.text or "") for text in chart.iter("text") if re.fullmatch(r"-?[\d.]+", text.text or "")]
    assert len(numbers) >= 6
    x, y, width, height = (float(value) for value in chart.attrib["viewBox"].split())
    for dot in chart.iter("circle"):
        assert x <= float(dot.attrib["cx"]) <= x + width
        assert y <= float(dot.attrib["cy"]) <= y + height


def test_sections_are_lines_of_numbers(tin):
    lines = list(csv.DictReader(StringIO(export_decision(tin, "csv").decode(), newline="")))
    result = tin.replay.result
    assert list(lines[0]) == COLUMNS
    assert [int(line["section"]) for line in lines] == list(range(1, len(lines) + 1))
    assert lines[5]["state"] == "excluded"
    used = [line for line in lines if line["state"] == "used"]
    assert len(used) == tin.evidence.answer["sections"]["used"]
    low, high, radius = (
        np.array([float(line[name]) for line in used]) for name in ("radius_low_mm", "radius_high_mm", "radius_mm")
    )
    assert ((low < radius) & (radius < high)).all()
    centers = np.array([[float(line[f"center_{axis}_m"]) for axis in "xyz"] for line in used])
    np.testing.assert_allclose(result.solid.distance(centers), -result.solid.radius_m, atol=0.01)
    assert sum(int(line["pixels"]) for line in lines) == len(result.sections.pixel)


def test_points_carry_what_the_segmentation_made_of_them(tin):
    result = tin.replay.result
    vertices = PlyData.read(BytesIO(export_decision(tin, "ply")))["vertex"].data
    places = np.stack([vertices["x"], vertices["y"], vertices["z"]], axis=1)
    kept = np.union1d(result.segments.pixel[result.segmentation.kept], result.sections.pixel)
    meant = vertices["label"] == Label.OBJECT
    wanted = transform(TURNED, result.frame.points_m.reshape(-1, 3)[kept])
    np.testing.assert_allclose(places[meant], wanted, atol=1e-6)
    assert set(np.unique(vertices["label"])) <= {label.value for label in Label}
    assert (vertices["section"] > 0).sum() == len(result.sections.pixel)
    assert np.abs(result.solid.distance(places[vertices["section"] > 0])).mean() < 0.002


@pytest.mark.parametrize("kind", ["glb", "stl"])
def test_the_solid_opens_as_a_closed_mesh_of_its_size_in_metres(tin, kind):
    mesh = trimesh.load_mesh(BytesIO(export_decision(tin, kind)), file_type=kind)
    solid = tin.replay.result.solid
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(np.pi * solid.radius_m**2 * solid.length_m, rel=0.01)
    np.testing.assert_allclose(mesh.center_mass, solid.center_m, atol=1e-4)


def test_json_holds_all_that_was_recorded_and_needs_no_measurement(tmp_path):
    with closing(Record.open(tmp_path)) as record:
        for entry in (Entry("proposal", "ann", "a" * 64), Entry("declined", "eve"), Entry("armed", "ann", "a" * 64)):
            record.append(entry, None)
        content = json.loads(export_entry(record, 1, "json"))
        assert content["head"] == str(record.head)
        assert content["entry"] == {"hash": record.entry(1).hash, **record.entry(1).content}
        assert [entry["id"] for entry in content["trail"]] == [1, 3]
        assert [entry["id"] for entry in json.loads(export_entry(record, 2, "json"))["trail"]] == [2]


def test_a_proposal_keeps_a_small_picture(decision):
    picture = decision.evidence.entry.content["payload"]["picture"]
    content = cv2.imdecode(np.frombuffer(base64.b64decode(picture.split(",")[1]), np.uint8), cv2.IMREAD_COLOR)
    assert content.shape == (144, 192, 3)
    assert len(picture) < 10_000


def test_what_was_not_measured_has_no_solid(wall):
    for kind in ("glb", "stl"):
        with pytest.raises(NothingToExport, match="entry 3 has no solid"):
            export_decision(wall, kind)
