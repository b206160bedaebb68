"""The command that opens the console: what it is started with, and what it refuses."""

import socket
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from rotrecon.frame import Frame
from rotrecon.settings import Method, Settings
from rotrecon.simulation.simulate import simulate
from rotrecon.simulation.truth import write_simulated
from tests.recordings import recording
from tests.scenes import save, with_views


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scenes") / "pipe"
    write_simulated(folder, simulate("pipe", 3, supersampling=1))
    return folder


def test_serve_opens_views_with_coarse_depth(rotrecon, monkeypatch):
    served: list[tuple[Frame, tuple[str, ...]]] = []
    monkeypatch.setattr("app.serving.serve", lambda frame, *_, notes, **__: served.append((frame, notes)))
    assert rotrecon("serve", recording("virtual_stereo"))[0] == 0
    frame, notes = served[0]
    assert frame.stereo.scale == 0.5
    assert np.isfinite(frame.depth_m).mean() > 0.8
    assert any("Matched from 2 views" in note for note in notes)


def test_serve_refuses_views_that_cannot_be_matched_with_their_reason(rotrecon, tmp_path):
    code, _, err = rotrecon("serve", save(tmp_path, with_views({}, {})))
    assert code == 3
    assert "move the camera sideways" in err


def test_serve_marks_classes_dangerous_and_keeps_a_record(rotrecon, scene, tmp_path, monkeypatch):
    served: list[dict[str, Any]] = []
    monkeypatch.setattr("app.serving.serve", lambda *_, **options: served.append(options))
    assert rotrecon("serve", scene, "--dangerous", "cone", "--dangerous", "sphere", "--data", tmp_path)[0] == 0
    assert served[0]["deciding"].dangerous == {"cone", "sphere"}
    assert served[0]["record"].folder == tmp_path
    code, _, err = rotrecon("serve", scene, "--dangerous", "bomb")
    assert code == 2
    assert "bomb is no class" in err


def test_serve_measures_by_the_method_that_is_given(rotrecon, scene, monkeypatch):
    served: list[Settings] = []
    monkeypatch.setattr("app.serving.serve", lambda frame, name, settings, *_, **__: served.append(settings))
    for method in get_args(Method):
        assert rotrecon("serve", scene, "--method", method)[0] == 0
    assert [settings.method for settings in served] == list(get_args(Method))


def test_serve_refuses_a_host_that_is_not_this_machine(rotrecon, scene):
    for host in ("nonsense.invalid", "203.0.113.5"):
        code, _, err = rotrecon("serve", scene, "--host", host)
        assert code == 2
        assert host in err
        assert err.count("\n") == 1


def test_serve_refuses_what_is_not_guarded_and_half_a_certificate(rotrecon, scene, tmp_path):
    code, _, err = rotrecon("serve", scene, "--host", "0.0.0.0", "--data", tmp_path)
    assert code == 2
    assert "rotrecon user add" in err
    assert "--certificate" in err
    code, _, err = rotrecon("serve", scene, "--certificate", tmp_path / "cert.pem")
    assert code == 2
    assert "--key" in err


def test_serve_refuses_a_port_that_is_taken(rotrecon, scene):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        code, _, err = rotrecon("serve", scene, "--port", taken.getsockname()[1])
    assert code == 2
    assert "give another one with --port" in err
    assert err.count("\n") == 1
