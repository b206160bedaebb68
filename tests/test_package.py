"""The wheel: everything the program needs is in it, and it runs outside the checkout."""

import json
import os
import socket
import subprocess
import sys
import sysconfig
import tomllib
import urllib.request
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(out), str(ROOT)]
    subprocess.run(command, check=True, capture_output=True)
    (built,) = out.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment with nothing but the wheel; its dependencies are lent by the environment of the tests."""
    place = tmp_path_factory.mktemp("environment")
    venv.create(place, with_pip=False)
    python = place / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", "--no-deps", "--no-index"]
    subprocess.run([*pip, str(wheel)], check=True)
    (packages,) = (place / "lib").glob("python3*/site-packages")
    # a path in a .pth file is searched, but its own .pth files are not: the editable install stays unseen
    (packages / "lent.pth").write_text(sysconfig.get_paths()["purelib"] + "\n")
    return place / "bin" / "rotrecon"


def run(installed: Path, folder: Path, *arguments: str) -> str:
    done = subprocess.run([installed, *arguments], cwd=folder, capture_output=True, text=True, check=True)
    return done.stdout


def test_wheel_holds_both_packages_the_tools_and_the_static_files(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    expected = [path for folder in ("rotrecon", "app") for path in (ROOT / folder).rglob("*.py")]
    assert {str(path.relative_to(ROOT)) for path in expected} <= set(names)
    assert "rotrecon/tools.toml" in names
    static = [f"app/static/{path.name}" for path in (ROOT / "static").iterdir() if not path.name.startswith(".")]
    assert static
    assert set(static) <= set(names)


def test_installed_program_simulates_and_measures(installed, tmp_path):
    run(installed, tmp_path, "simulate", "leg")
    truth = json.loads((tmp_path / "leg" / "truth.json").read_text())
    out = run(installed, tmp_path, "fit", "leg", "--area", truth["area"], "--axis", truth["axis"], "--json")
    assert json.loads(out)["kind"] == "cylinder"
    where = "import rotrecon, app; print(rotrecon.__file__, app.__file__)"
    python = installed.with_name("python")
    found = subprocess.run([python, "-c", where], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert str(ROOT) not in found


def test_installed_console_answers(installed, tmp_path):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(
        [installed, "serve", "--port", str(port)], cwd=tmp_path, stdout=subprocess.PIPE, text=True, env=environment
    ) as console:
        try:
            assert console.stdout is not None
            assert any(f"http://127.0.0.1:{port}" in line for line in console.stdout)
            with urllib.request.urlopen(f"http://127.0.0.1:{port}", timeout=10) as page:
                assert page.status == 200
        finally:
            console.terminate()


@pytest.mark.parametrize(
    ("given", "runs"),
    [
        ((), "serve"),
        (("SCENE=a",), "serve a"),
        (("PORT=8090",), "serve --port 8090"),
        (("SCENE=a", "PORT=8090"), "serve a --port 8090"),
    ],
)
def test_make_run_opens_a_scene_on_a_port(given, runs):
    outside = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}  # of `make test`
    environment = {**outside, "PORT": "1"}  # another program's, as many shells have it
    said = subprocess.run(
        ["make", "--dry-run", "run", *given], cwd=ROOT, capture_output=True, text=True, check=True, env=environment
    )
    assert said.stdout.splitlines()[-1].split()[1:] == runs.split()


def test_dependencies_are_pinned_by_name_and_version_alone():
    constraints = (ROOT / "constraints.txt").read_text().split()
    assert all("==" in line and "/" not in line for line in constraints)
    pinned = {line.split("==")[0].lower().replace("_", "-") for line in constraints}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = project["dependencies"] + project["optional-dependencies"]["test"]
    names = {word.split(">")[0].split("[")[0].lower() for word in wanted}
    assert names <= pinned
