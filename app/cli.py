"""The `rotrecon` command."""

import json
import sys
from contextlib import closing
from math import inf
from pathlib import Path
from typing import Annotated, Literal, get_args

import typer

from app import bench_cli, log_cli, user_cli
from app.deciding.settings import DecisionSettings
from app.describe import describe, describe_result, matching_notes
from app.door.people import PeopleError, people_file
from app.drawing_text import parse_area, parse_axis, stroke_text
from app.flaw_text import FLAW_HELP, parse_flaws
from app.host import HostError
from app.record.errors import StoreError
from app.record.store import Record
from app.writing import write_file
from rotrecon.answer import answer, cannot
from rotrecon.capture import Capture
from rotrecon.drawing import Constraints, Direction, Drawing, DrawingError, ObjectAxis
from rotrecon.errors import SceneError
from rotrecon.frame import Frame, FrameUnavailable
from rotrecon.outcome import FitFailure
from rotrecon.overlay import outlines, with_outlines, with_segmentation
from rotrecon.primitives import Kind
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.scene.formats.image import encode_png
from rotrecon.scene.importing import ImportOptions, import_scene
from rotrecon.scene.intrinsics import Intrinsics
from rotrecon.scene.reading import read_scene
from rotrecon.settings import Method, Settings
from rotrecon.simulation.simulate import simulate as simulate_object
from rotrecon.simulation.stereo import VIEW_STEP_M, simulate_views
from rotrecon.simulation.surfaces import Texture
from rotrecon.simulation.truth import TRUTH_FILE, write_simulated
from rotrecon.tool_table import ToolTableError, default_tools, read_tools

cli = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Measures objects of revolution in front of a robot arm, and names the tool that fits them.",
)
log_cli.add_to(cli)
user_cli.add_to(cli)
bench_cli.add_to(cli)
DEMO = "leg"
BAD_INPUT, CANNOT = 2, 3

Scene = Annotated[Path, typer.Argument(metavar="SCENE", help="A scene folder.")]
Layers = Annotated[
    int, typer.Option(min=1, max=9, help="Objects that overlap in depth in the area: the closest one is measured.")
]
MethodName = Annotated[Method, typer.Option(help="How it is measured.")]
ToolFile = Annotated[Path | None, typer.Option(metavar="FILE", help="A tool table in place of the one that ships.")]


def main() -> None:
    """Run the command; bad input is one sentence on stderr and exit code 2."""
    try:
        cli()
    except (SceneError, DrawingError, ToolTableError, HostError, StoreError, PeopleError) as error:
        typer.echo(f"rotrecon: {error}", err=True)
        sys.exit(BAD_INPUT)


@cli.command()
def fit(
    scene: Scene,
    area: Annotated[str, typer.Option(help='Corners "u,v u,v" of a rectangle, or of a polygon if more, px.')],
    axis: Annotated[
        str | None, typer.Option(help='A stroke "u,v u,v" along the object, px; proposed when left out.')
    ] = None,
    kind: Annotated[
        Literal["auto", "cylinder", "rod", "sphere", "cone"], typer.Option(help="What it is, if you know.")
    ] = "auto",
    diameter: Annotated[
        str | None, typer.Option(metavar="LOW,HIGH", help="Its limits, mm; one number if it is known.")
    ] = None,
    direction: Annotated[Direction, typer.Option(help="How its axis lies; plane: square to the table.")] = "free",
    method: MethodName = Settings.method,
    tools: ToolFile = None,
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    overlay: Annotated[Path | None, typer.Option(metavar="OUT.png", help="Write the frame with the result.")] = None,
    layers: Layers = 2,
) -> None:
    """Measure the object that a drawing points at. Exits with 0 for a result, 3 for a reasoned "cannot"."""
    drawing = Drawing(
        parse_area(area),
        None if axis is None else parse_axis(axis),
        None if kind == "auto" else kind,
        constraints=Constraints(None if diameter is None else _radius_m(diameter), direction),
    )
    settings = Settings(method=method, layers=layers, tools=default_tools() if tools is None else read_tools(tools))
    if overlay is not None and overlay.suffix.lower() != ".png":
        raise typer.BadParameter(f"--overlay {overlay} is not a PNG; name a file that ends in .png")
    frame = read_scene(scene).frame(drawing.area, settings)
    if isinstance(frame, FrameUnavailable):
        content = cannot(frame.reason, method)
        typer.echo(_json(content) if json_ else describe(content))
        raise typer.Exit(CANNOT)
    result = reconstruct(frame, drawing, settings)
    if overlay is not None:
        _write_overlay(overlay, result)
    typer.echo(_json(answer(result)) if json_ else _in_words(result, drawing.axis))
    if isinstance(result.fit, FitFailure):
        raise typer.Exit(CANNOT)


def _radius_m(diameter: str) -> tuple[float, float]:
    try:
        ends = [float(word) for word in diameter.split(",")]
    except ValueError:
        ends = []
    if len(ends) not in (1, 2) or not 0 < ends[0] <= ends[-1] < inf:
        raise typer.BadParameter(f"--diameter {diameter} is no diameter in mm; write limits as 60,70 or one number")
    return (ends[0] / 2000, ends[-1] / 2000)


def _in_words(result: Reconstruction, drawn: ObjectAxis | None) -> str:
    words, stroke = describe_result(result), result.drawing.stroke
    if stroke == drawn:
        return words
    return f"{words}\n  axis {'proposed' if drawn is None else 'put right'}: --axis {stroke_text(stroke)}"


def _json(content: dict[str, object]) -> str:
    return json.dumps(content, allow_nan=False)


def _write_overlay(path: Path, result: Reconstruction) -> None:
    image = with_outlines(with_segmentation(result.frame.image, result), outlines(result))
    write_file(path, "the overlay", encode_png(image))


@cli.command()
def serve(
    scene: Annotated[Path | None, typer.Argument(metavar="[SCENE]", help="A scene folder; without: a demo.")] = None,
    host: Annotated[str, typer.Option(help="Address to listen on; others can reach it only with users and TLS.")] = (
        "127.0.0.1"
    ),
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port to listen on.")] = 8080,
    certificate: Annotated[Path | None, typer.Option(metavar="FILE", help="TLS certificate, PEM.")] = None,
    key: Annotated[Path | None, typer.Option(metavar="FILE", help="Private key of the certificate, PEM.")] = None,
    data: Annotated[
        Path | None, typer.Option(metavar="DIR", help="The folder of the record and the users; else your own.")
    ] = None,
    dangerous: Annotated[
        list[str] | None, typer.Option(metavar="CLASS", help="Marked dangerous: you name it before it is proposed.")
    ] = None,
    method: MethodName = Settings.method,
    tools: ToolFile = None,
    layers: Layers = 2,
) -> None:
    """Open the operator's console on a scene; the link it prints logs in."""
    if (certificate is None) != (key is None):
        raise typer.BadParameter("--certificate and --key belong together; give both")
    deciding = DecisionSettings(dangerous=_kinds(dangerous or []))
    capture = _demo() if scene is None else read_scene(scene)
    frame = capture.frame()
    if isinstance(frame, FrameUnavailable):
        typer.echo(f"rotrecon: {frame.reason}", err=True)
        raise typer.Exit(CANNOT)
    settings = Settings(method=method, layers=layers, tools=default_tools() if tools is None else read_tools(tools))
    from app.door.listening import Certificate
    from app.serving import serve as serve_console  # viser takes a second to import, which no other command needs

    files = None if certificate is None or key is None else Certificate(certificate, key)
    people, notes = people_file(data), (*capture.notes, *matching_notes(frame))
    with closing(Record.open(data)) as record:
        serve_console(
            frame,
            capture.name,
            settings,
            host,
            port,
            people=people,
            certificate=files,
            record=record,
            deciding=deciding,
            capture=capture,
            notes=notes,
            tour=scene is None,
        )


def _kinds(names: list[str]) -> frozenset[Kind]:
    kinds: dict[str, Kind] = {kind: kind for kind in get_args(Kind)}
    for name in names:
        if name not in kinds:
            raise typer.BadParameter(f"--dangerous {name} is no class; name one of {', '.join(kinds)}")
    return frozenset(kinds[name] for name in names)


def _demo() -> Capture:
    frame: Frame = simulate_object(DEMO, seed=0).frame
    return Capture(f"Demo: a simulated chair {DEMO}, 36 mm", recorded=frame)


@cli.command()
def simulate(
    out: Annotated[Path, typer.Argument(metavar="OUT", help="The scene folder to write.")],
    object_: Annotated[
        Literal["leg", "ball", "wire", "pipe", "cone"], typer.Option("--object", help="What stands in it.")
    ] = DEMO,
    seed: Annotated[int, typer.Option(min=0, help="Another one gives another pose.")] = 0,
    views: Annotated[
        int | None, typer.Option(min=2, max=4, help="Pictures 0.1 m apart in place of a frame with depth.")
    ] = None,
    texture: Annotated[Texture, typer.Option(help="Of the object, in views.")] = "fine",
    flaw: Annotated[list[str] | None, typer.Option(metavar="NAME=AMOUNT", help=FLAW_HELP)] = None,
) -> None:
    """Write a scene whose truth is known, and the truth beside it."""
    if views is None:
        if flaw or texture != "fine":
            raise typer.BadParameter("--texture and --flaw are of views; add --views 2")
        simulated = simulate_object(object_, seed)
    else:
        baselines_m = [VIEW_STEP_M * number for number in range(views)]
        simulated = simulate_views(
            object_, seed, baselines_m=baselines_m, texture=texture, flaws=parse_flaws(flaw or [])
        )
    write_simulated(out, simulated)
    typer.echo(
        f"wrote {out}: a {object_}, {simulated.diameter_mm:g} mm in diameter; its truth is in {out / TRUTH_FILE}"
    )


@cli.command("import")
def import_(
    source: Annotated[Path, typer.Argument(metavar="SOURCE", help="A PCD, PLY, NPZ, picture, or ROS 1 or 2 bag.")],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="The scene folder to write.")],
    depth: Annotated[Path | None, typer.Option(metavar="FILE", help="The depth map of a picture.")] = None,
    depth_scale: Annotated[float | None, typer.Option(help="Metres of one count of a depth PNG.")] = None,
    intrinsics: Annotated[str | None, typer.Option(metavar="FX,FY,CX,CY", help="Of the camera, px.")] = None,
    size: Annotated[str | None, typer.Option(metavar="WxH", help="Camera of an unorganised cloud, px.")] = None,
    topic: Annotated[str | None, typer.Option(help="The PointCloud2 topic of a bag.")] = None,
    name: Annotated[str | None, typer.Option(help="The scene's name.")] = None,
) -> None:
    """Make a scene folder from a foreign recording."""
    camera = None if intrinsics is None else _intrinsics(intrinsics)
    shape = None if size is None else _size(size)
    capture = import_scene(source, out, ImportOptions(depth, depth_scale, camera, shape, topic, name))
    typer.echo(f"wrote {out}: {capture.name}")
    for note in capture.notes:
        typer.echo(f"  {note}")


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise typer.BadParameter(f"--size {text} is not a size; write it as 640x480")
    return (int(width), int(height))


def _intrinsics(text: str) -> Intrinsics:
    try:
        fx, fy, cx, cy = (float(word) for word in text.split(","))
    except ValueError as error:
        raise typer.BadParameter(f"--intrinsics {text} is not four numbers; write them as fx,fy,cx,cy") from error
    return Intrinsics(fx, fy, cx, cy)
