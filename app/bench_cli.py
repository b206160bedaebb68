"""`rotrecon bench`: the program measured, as figures at a terminal or as documents."""

from pathlib import Path
from typing import Annotated

import typer

from app.writing import write_file

NO_PEER = 2
"""Exit code when what the program is compared with is not installed."""


def add_to(cli: typer.Typer) -> None:
    """The command, as part of the program's."""
    cli.command("bench")(bench)


def bench(
    paper_method: Annotated[
        Path | None, typer.Option(metavar="OUT.md", help="Write how good the paper's method is; takes minutes.")
    ] = None,
    accuracy: Annotated[
        Path | None, typer.Option(metavar="OUT.md", help="Write how accurate the program is; takes half an hour.")
    ] = None,
    table2: Annotated[
        Path | None, typer.Option(metavar="OUT.md", help="Write the paper's table 2 again; takes a quarter of an hour.")
    ] = None,
    door: Annotated[
        bool, typer.Option("--door", help="Twenty pages, 2,000 drawings and 1,000 forged messages; takes six minutes.")
    ] = False,
    recordings: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Recorded scenes to measure too, for --accuracy.")
    ] = None,
) -> None:
    """Measure the program itself: speed and size in some minutes, how accurate it is, or the paper's method."""
    if accuracy is not None:
        from app.bench.accuracy.document import accuracy_document
        from app.bench.accuracy.peers import PeerMissing

        try:
            write_file(accuracy, "the document", accuracy_document(recordings).encode())
        except PeerMissing as error:
            typer.echo(f"rotrecon: {error}", err=True)
            raise typer.Exit(NO_PEER) from error
        typer.echo(f"wrote {accuracy}")
        return
    if table2 is not None:
        from app.bench.table2.document import table2_document

        write_file(table2, "the document", table2_document().encode())
        typer.echo(f"wrote {table2}")
        return
    if paper_method is not None:
        from app.bench.paper_method import paper_method_document

        write_file(paper_method, "the document", paper_method_document().encode())
        typer.echo(f"wrote {paper_method}")
        return
    if door:
        from app.bench.crowd import crowd_report
        from app.bench.forged import forge, forged_report
        from app.bench.served import served

        with served("paper") as house:
            typer.echo(crowd_report(house))
            typer.echo(f"\n{forged_report(forge(house))}")
        return
    from app.bench.console_speed import console_report  # no other command needs the benchmarks
    from app.bench.speed import speed_report
    from app.bench.stereo_speed import stereo_report

    typer.echo(speed_report())
    typer.echo(f"\n{stereo_report()}")
    typer.echo(f"\n{console_report()}")
