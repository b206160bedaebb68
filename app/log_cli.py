"""`rotrecon log` and `rotrecon replay`: the record at a terminal."""

import json
from contextlib import closing
from pathlib import Path
from typing import Annotated, Any, Literal, NoReturn, get_args

import typer

from app.describe import describe
from app.record.entries import EntryKind, Head, Written
from app.record.errors import NoSuchEntry
from app.record.evidence import evidence_of, replay, said_with
from app.record.history import why
from app.record.store import Record
from app.record.verify import verify
from app.replay_text import replay_lines
from app.writing import write_file
from rotrecon.drawing import DrawingError

DIFFERENT, NOTHING = 1, 3
"""Exit codes: a record that is not whole or a number that is not the same; nothing there to show or compute."""

LINE_CHARACTERS = 120
"""Of an entry in a list: what terminals and logs show without breaking it. `log show` says all of it."""
TOOL_CHARACTERS = 18
"""Of the column of tools: the longest of the table that ships has 17."""

Data = Annotated[
    Path | None, typer.Option("--data", metavar="DIR", help="The record's folder; the user's own when left out.")
]
Number = Annotated[int, typer.Argument(metavar="ID", help="The number of an entry.")]

log = typer.Typer(no_args_is_help=True, help="The record of what was proposed and decided.")


def add_to(cli: typer.Typer) -> None:
    """The commands of the record, as part of the program's."""
    cli.add_typer(log, name="log")
    cli.command("replay")(replay_)


@log.command("list")
def list_(
    data: Data = None,
    kind: Annotated[str | None, typer.Option(help=f"Of one kind only: {', '.join(get_args(EntryKind))}.")] = None,
    last: Annotated[int | None, typer.Option(min=1, help="So many of the latest only.")] = None,
) -> None:
    """List the entries, and the head that the record ends with."""
    chosen = next((one for one in get_args(EntryKind) if one == kind), None)
    if kind is not None and chosen is None:
        raise typer.BadParameter(f"--kind {kind} is none of {', '.join(get_args(EntryKind))}")
    with closing(Record.read(data)) as record:
        for written in record.entries(kind=chosen, last=last):
            typer.echo(_line(written))
        typer.echo(f"head {record.head}")


@log.command()
def show(number: Number, data: Data = None) -> None:
    """Show one entry: who, when, what it was about, and with which versions."""
    with closing(Record.read(data)) as record:
        written = _entry(record, number)
        content = written.content
        typer.echo(_line(written))
        typer.echo(f"  hash {written.hash}\n  previous {content['previous']}\n  digest {content['digest'] or 'none'}")
        typer.echo(f"  {', '.join(f'{name} {version}' for name, version in content['versions'].items())}")
        for name, value in said_with(written).items():
            typer.echo(f"  {name}: {value if isinstance(value, str) else json.dumps(value)}")
        if "answer" in content["payload"]:
            typer.echo(describe(content["payload"]["answer"]))


@log.command("verify")
def verify_(
    data: Data = None,
    head: Annotated[
        str | None, typer.Option(metavar="HEAD", help="One that was noted, as in a report: is it still part of it?")
    ] = None,
) -> None:
    """Check that no entry and no scene was changed or lost. Exits with 1 when one was."""
    try:
        kept = None if head is None else Head.parse(head)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from error
    with closing(Record.read(data)) as record:
        fault, end = verify(record, kept), record.head
    if fault is not None:
        typer.echo(f"entry {fault.id} {fault.problem}")
        raise typer.Exit(DIFFERENT)
    typer.echo(f"the record is whole; entries: {end.id}, head {end}")


@log.command()
def export(
    number: Number,
    out: Annotated[Path, typer.Argument(metavar="[OUT]", help="A file, or a folder to write it in.")] = Path(),
    format_: Annotated[
        Literal["html", "json", "csv", "ply", "glb", "stl"],
        typer.Option("--format", help="Report, all that is known, sections, points, or the solid."),
    ] = "html",
    data: Data = None,
) -> None:
    """Write what there is to report of an entry into a file."""
    from app.report.exports import NothingToExport, export_entry, file_name  # templates and meshes take time to load

    with closing(Record.read(data)) as record:
        try:
            content = export_entry(record, number, format_)
        except (NoSuchEntry, NothingToExport, DrawingError) as error:
            _nothing(error)
    path = out / file_name(number, format_) if out.is_dir() else out
    write_file(path, "the export", content)
    typer.echo(f"wrote {path}")


def replay_(number: Number, data: Data = None) -> None:
    """Compute an entry again from the stored scene. Exits with 1 when a number is not the same."""
    with closing(Record.read(data)) as record:
        try:
            again = replay(evidence_of(record, record.entry(number)))
        except (NoSuchEntry, DrawingError) as error:
            _nothing(error)
    typer.echo(replay_lines(number, again))
    if not again.same:
        raise typer.Exit(DIFFERENT)


def _line(written: Written) -> str:
    """An entry in one line: number, time, kind, digest, tool, who, and what was measured or why."""
    content, said = written.content, said_with(written)
    answer = content["payload"].get("answer") or {}
    digest, tool = (content["digest"] or "-")[:8], said.get("tool") or answer.get("tool") or "-"
    line = f"{written.id:5}  {content['when'][:19]}Z  {content['kind']:10}  {digest:8}  "
    line += f"{_cut(tool, TOOL_CHARACTERS):{TOOL_CHARACTERS}}  {content['who']}"
    what = _measured(answer) or why(said)
    return _cut(f"{line}: {what}" if what else line, LINE_CHARACTERS)


def _measured(answer: dict[str, Any]) -> str:
    """What was measured, or why that led to no tool."""
    if not answer:
        return ""
    return f"{answer['kind']} {answer['diameter_mm']:.1f} mm" if answer["tool"] else next(iter(answer["reasons"]), "")


def _cut(text: str, characters: int) -> str:
    """A text on one line that is no longer than that."""
    text = text.replace("\n", " ")
    return text if len(text) <= characters else f"{text[: characters - 1]}…"


def _entry(record: Record, number: int) -> Written:
    try:
        return record.entry(number)
    except NoSuchEntry as error:
        _nothing(error)


def _nothing(error: Exception) -> NoReturn:
    typer.echo(f"rotrecon: {error}", err=True)
    raise typer.Exit(NOTHING) from error
