"""The command, as it is typed: measuring, simulating, importing."""

import json
import re
from pathlib import Path

import cv2
import numpy as np
import pytest

from rotrecon.frame import Frame
from rotrecon.scene.reading import read_scene
from rotrecon.scene.writing import SceneRecord, write_scene
from rotrecon.simulation.simulate import simulate
from rotrecon.simulation.truth import write_simulated
from tests.exact import CAMERA
from tests.recordings import recording
from tests.scenes import save, with_views

GREY = np.full((240, 320, 3), 128, np.uint8)


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scenes") / "pipe"
    write_simulated(folder, simulate("pipe", 3, supersampling=1))
    return folder


def drawing_of(scene: Path) -> list[str]:
    truth = json.loads((scene / "truth.json").read_text())
    return ["--area", truth["area"], "--axis", truth["axis"]]


def test_fit_prints_one_json_object_and_draws_it(rotrecon, scene, tmp_path):
    code, out, err = rotrecon("fit", scene, *drawing_of(scene), "--json", "--overlay", tmp_path / "out.png")
    assert (code, err) == (0, "")
    assert out.count("\n") == 1
    assert json.loads(out)["kind"] == "cylinder"
    assert cv2.imread(str(tmp_path / "out.png")).shape == (480, 640, 3)
    assert [path.name for path in tmp_path.iterdir()] == ["out.png"]


def test_fit_in_words(rotrecon, scene):
    code, out, _ = rotrecon("fit", scene, *drawing_of(scene))
    assert code == 0
    assert "mm in diameter" in out
    assert "tool: mechanical cutter" in out
    assert "\n  certain\n" in out
    assert "(95 %:" in out.splitlines()[0]
    assert "this noise is: " in out
    assert "first cut" not in out


def test_the_method_of_the_paper_shows_its_cuts_and_claims_no_certainty(rotrecon, scene):
    code, out, _ = rotrecon("fit", scene, *drawing_of(scene), "--method", "paper")
    assert code == 0
    assert "the first cut alone gives" in out
    assert "the paper's method has no measure of either" in out
    assert "95 %" not in out


def test_kind_and_tools_can_be_given(rotrecon, scene, tmp_path):
    table = tmp_path / "tools.toml"
    table.write_text('[saw]\nname = "saw"\ntakes = ["rod"]\ndiameter_mm = [1, 500]\n')
    code, out, _ = rotrecon("fit", scene, *drawing_of(scene), "--kind", "rod", "--tools", table, "--json")
    assert code == 0
    assert json.loads(out)["kind"] == "rod"
    assert json.loads(out)["candidates"][0]["kind"] == "rod"
    assert json.loads(out)["tool"] == "saw"


def test_honest_cannot_is_json_with_exit_code_3(rotrecon, tmp_path):
    depth = np.random.default_rng(0).normal(1.0, 0.001, (240, 320))
    write_scene(tmp_path / "wall", SceneRecord("wall", Frame(GREY, CAMERA.cloud(depth), CAMERA)))
    drawing = ["--area", "60,60 260,190", "--axis", "160,70 160,180"]
    code, out, _ = rotrecon("fit", tmp_path / "wall", *drawing, "--json", "--overlay", tmp_path / "out.png")
    answer = json.loads(out)
    assert code == 3
    assert answer["kind"] is None
    assert len(answer["reasons"]) == 1
    assert (tmp_path / "out.png").exists(), "what was segmented explains the refusal"
    code, out, _ = rotrecon("fit", tmp_path / "wall", *drawing)
    assert code == 3
    assert out.startswith("No result:")


def test_views_are_matched_in_the_area_and_measured(rotrecon):
    drawing = ["--area", "400,590 680,870", "--axis", "541,620 541,840"]
    code, out, _ = rotrecon("fit", recording("virtual_stereo"), *drawing, "--json")
    answer = json.loads(out)
    assert code == 0
    assert answer["kind"] == "sphere"
    assert answer["diameter_mm"] == pytest.approx(100, rel=0.005)
    assert answer["stereo"]["views"] == [1, 2]
    assert answer["stereo"]["epipolar_error_px"] < 0.2
    assert answer["stereo"]["valid_share"] > 0.9


def test_views_that_cannot_be_matched_are_an_honest_cannot(rotrecon, tmp_path):
    scene = with_views({}, {})
    code, out, _ = rotrecon("fit", save(tmp_path, scene), "--area", "1,1 6,4", "--json")
    assert code == 3
    assert "move the camera sideways" in json.loads(out)["reasons"][0]


@pytest.mark.parametrize("name", ["tin", "blue_mug", "green_bowl", "pr2_mug", "concrete_pipe"])
def test_every_recording_gets_an_answer_in_the_stated_form(rotrecon, name):
    command = ["fit", recording(name), "--area", "300,200 380,320", "--axis", "340,210 340,310", "--json"]
    code, out, _ = rotrecon(*command)
    assert code in (0, 3)
    assert json.loads(out)["method"] == "robust"
    code, out, _ = rotrecon(*command, "--method", "paper")
    assert code in (0, 3)
    assert json.loads(out)["method"] == "paper"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--area", "1,2", "--axis", "1,2 3,4"], "two corners"),
        (["--area", "1,2 x,4", "--axis", "1,2 3,4"], '"x,4" is not a pixel'),
        (["--area", "1,2 3,nan", "--axis", "1,2 3,4"], "not a pixel"),
        (["--area", "10,10 90,90", "--axis", "1,2"], "write its two ends"),
        (["--area", "10,10 900,90", "--axis", "20,20 80,80"], "outside the frame"),
        (["--area", "10,10 10,10", "--axis", "20,20 80,80"], "no size"),
        (["--area", "10,10 90,90 90,10 10,90", "--axis", "20,20 80,80"], "crosses or touches itself"),
        (["--area", "10,10 90,90", "--axis", "20,20 20,20"], "no length"),
        (["--area", "10,10 90,90", "--axis", "300,20 300,90"], "outside the area"),
    ],
)
def test_bad_drawings_are_one_sentence_and_exit_code_2(rotrecon, scene, arguments, says):
    code, out, err = rotrecon("fit", scene, *arguments, "--json")
    assert (code, out) == (2, "")
    assert says in err
    assert err.count("\n") == 1


def test_area_without_depth_and_missing_things(rotrecon, scene, tmp_path):
    assert rotrecon("fit", tmp_path / "none", "--area", "1,1 9,9", "--axis", "2,2 8,8")[0] == 2
    bad_tools = tmp_path / "tools.toml"
    bad_tools.write_text("[cutter]\n")
    code, _, err = rotrecon("fit", scene, *drawing_of(scene), "--tools", bad_tools)
    assert code == 2
    assert "[cutter]" in err
    code, _, err = rotrecon("fit", scene, *drawing_of(scene), "--overlay", tmp_path / "none" / "out.png")
    assert code == 2
    assert "cannot be written" in err


def test_simulate_writes_a_scene_that_fit_reads_and_never_over_another(rotrecon, tmp_path):
    code, out, _ = rotrecon("simulate", tmp_path / "ball", "--object", "ball", "--seed", 4)
    assert code == 0
    assert "truth.json" in out
    command = ["fit", tmp_path / "ball", *drawing_of(tmp_path / "ball")]
    code, out, _ = rotrecon(*command, "--json")
    assert code == 0
    assert json.loads(out)["kind"] == "sphere"
    assert json.loads(out)["diameter_mm"] == pytest.approx(216, rel=0.005)
    assert "half the axis length (16)" in rotrecon(*command, "--method", "paper")[1]
    before = sorted((path.name, path.stat().st_mtime_ns) for path in (tmp_path / "ball").iterdir())
    code, _, err = rotrecon("simulate", tmp_path / "ball")
    assert code == 2
    assert "name a new folder" in err
    assert sorted((path.name, path.stat().st_mtime_ns) for path in (tmp_path / "ball").iterdir()) == before


def test_simulate_writes_views_and_refuses_flaws_it_does_not_know(rotrecon, tmp_path):
    flaws = ("--flaw", "blur=1", "--flaw", "shift=2", "--flaw", "occluder")
    code, out, _ = rotrecon(
        "simulate", tmp_path / "wire", "--object", "wire", "--views", 2, "--texture", "weak", *flaws
    )
    assert code == 0
    assert "25 mm" in out
    assert len(read_scene(tmp_path / "wire").views) == 2
    truth = json.loads((tmp_path / "wire" / "truth.json").read_text())
    assert truth["texture"] == "weak"
    stated = {name: truth["flaws"][name] for name in ("blur_px", "pose_error_m", "occluder", "neighbour", "gain")}
    assert stated == {"blur_px": 1.0, "pose_error_m": 0.002, "occluder": True, "neighbour": False, "gain": 1.0}
    for flaw in ("haze=1", "blur", "blur=much", "blur=-1", "occluder=2", "gain=nan"):
        code, _, err = rotrecon("simulate", tmp_path / "none", "--views", 2, "--flaw", flaw)
        assert code == 2, flaw
        assert "flaw" in err
    code, _, err = rotrecon("simulate", tmp_path / "none", "--texture", "weak")
    assert code == 2
    assert "--views" in err
    assert not (tmp_path / "none").exists()


def test_places_that_cannot_be_written_are_named(rotrecon, scene, tmp_path):
    code, _, err = rotrecon("simulate", tmp_path / ("a" * 300))
    assert code == 2
    assert "cannot be written" in err
    code, _, err = rotrecon("fit", scene, *drawing_of(scene), "--overlay", tmp_path / "out.jpg")
    assert code == 2
    assert "ends in .png" in err


def test_import_of_a_picture_with_depth(rotrecon, tmp_path):
    cv2.imwrite(str(tmp_path / "rgb.png"), np.full((60, 80, 3), 90, np.uint8))
    cv2.imwrite(str(tmp_path / "depth.png"), np.full((60, 80), 900, np.uint16))
    options = ["--depth", tmp_path / "depth.png", "--depth-scale", "0.001"]
    out = tmp_path / "scene"
    code, text, _ = rotrecon("import", tmp_path / "rgb.png", out, *options, "--intrinsics", "100,100,39.5,29.5")
    assert code == 0
    assert f"wrote {out}" in text
    for size in ("nanx5", "640.9x480", "640"):
        code, _, err = rotrecon("import", tmp_path / "rgb.png", tmp_path / "other", *options, "--size", size)
        assert code == 2
        assert "640x480" in err
    for wrong in ("100,100", "a,b,c,d"):
        code, _, err = rotrecon("import", tmp_path / "rgb.png", tmp_path / "other", *options, "--intrinsics", wrong)
        assert code == 2
        assert "--intrinsics" in err
        assert not (tmp_path / "other").exists()


def test_a_method_is_one_of_those_there_are(rotrecon, scene):
    for command in (["serve", scene], ["fit", scene, *drawing_of(scene)]):
        code, _, err = rotrecon(*command, "--method", "guess")
        assert code == 2
        assert "guess" in err


def test_fit_proposes_the_axis_that_is_left_out_and_says_so(rotrecon, scene):
    area = drawing_of(scene)[:2]
    code, out, _ = rotrecon("fit", scene, *area)
    proposed = re.search(r'axis proposed: --axis "(.*)"', out)
    assert code == 0
    assert proposed is not None
    again = rotrecon("fit", scene, *area, "--axis", proposed.group(1))[1]
    assert "axis proposed" not in again
    assert again.splitlines()[0] == out.splitlines()[0], "the proposed axis, given, measures the same"


def test_fit_puts_a_careless_axis_right_and_says_so(rotrecon, scene):
    *area, _, axis = drawing_of(scene)
    (u0, v0), (u1, v1) = (map(float, end.split(",")) for end in axis.split())
    short = f"{u0:g},{v0:g} {(u0 + u1) / 2:.1f},{(v0 + v1) / 2:.1f}"
    out = rotrecon("fit", scene, *area, "--axis", short)[1]
    mended = re.search(r'axis put right: --axis "(.*)"', out)
    assert mended is not None
    again = rotrecon("fit", scene, *area, "--axis", mended.group(1))[1]
    assert "put right" not in again
    assert again.splitlines()[0] == out.splitlines()[0]


def test_a_diameter_that_is_known_and_one_within_limits_are_kept(rotrecon, scene):
    fit = ["fit", scene, *drawing_of(scene), "--json"]
    free = json.loads(rotrecon(*fit)[1])["diameter_mm"]
    known = json.loads(rotrecon(*fit, "--diameter", f"{free + 0.05}")[1])
    assert known["diameter_mm"] == pytest.approx(free + 0.05, abs=1e-6)
    within = json.loads(rotrecon(*fit, "--diameter", f"{free - 5},{free + 5}")[1])
    assert within["diameter_mm"] == pytest.approx(free, abs=0.01)


def test_a_direction_that_is_held_is_that_of_the_axis(rotrecon):
    recorded = ["fit", recording("tin"), "--area", "270,50 380,232", "--axis", "325,75 325,222", "--json"]
    free = json.loads(rotrecon(*recorded)[1])
    held = json.loads(rotrecon(*recorded, "--direction", "plane")[1])
    assert held["axis"]["direction"] != free["axis"]["direction"]
    assert np.dot(held["axis"]["direction"], free["axis"]["direction"]) > np.cos(np.deg2rad(10))


@pytest.mark.parametrize("diameter", ["70,60", "0", "-5,60", "nan", "inf", "60,inf", "thick", "1,2,3", "", "60,"])
def test_a_diameter_that_cannot_be_is_refused(rotrecon, scene, diameter):
    code, _, err = rotrecon("fit", scene, *drawing_of(scene), "--diameter", diameter)
    assert code == 2
    assert "write limits as 60,70" in err
