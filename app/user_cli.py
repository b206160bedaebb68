"""`rotrecon user`: who may come in."""

import getpass
import sys
from pathlib import Path
from typing import Annotated

import typer

from app.door.people import (
    ROLES,
    PeopleError,
    Role,
    check_name,
    check_secret,
    people_file,
    read_people,
    with_person,
    write_people,
)

user = typer.Typer(no_args_is_help=True, help="Who may come in through the door: operators, watchers and robots.")
Data = Annotated[
    Path | None, typer.Option("--data", metavar="DIR", help="The folder of users; the user's own when left out.")
]
Name = Annotated[str, typer.Argument(metavar="NAME", help="As it will stand in the record.")]


def add_to(cli: typer.Typer) -> None:
    """Give a command line these commands."""
    cli.add_typer(user, name="user")


@user.command()
def add(
    name: Name,
    role: Annotated[Role, typer.Option(help="Operators decide, watchers look, robots use /api/v1.")] = "operator",
    data: Data = None,
) -> None:
    """Add a user, or give one another role and secret; the secret is asked for, or read from stdin."""
    path = people_file(data)
    people = read_people(path)
    check_name(name)
    write_people(path, with_person(people, name, role, _secret(name)))
    typer.echo(f"{'changed' if name in people else 'added'} {name}, {role}, in {path}")


@user.command("list")
def list_(data: Data = None) -> None:
    """Say who may come in."""
    people = read_people(people_file(data))
    for name, person in sorted(people.items()):
        typer.echo(f"{person.role:<{max(map(len, ROLES))}}  {name}")
    if not people:
        typer.echo("nobody yet; add a user with `rotrecon user add NAME`", err=True)


@user.command()
def remove(name: Name, data: Data = None) -> None:
    """Take a user away; whoever is logged in under that name is put out within seconds."""
    path = people_file(data)
    people = dict(read_people(path))
    if people.pop(name, None) is None:
        raise PeopleError(f"there is no user {name!r}; `rotrecon user list` says who there is")
    write_people(path, people)
    typer.echo(f"removed {name}")


def _secret(name: str) -> str:
    """From a person twice and without echo, judged before it is asked for again; from a script once."""
    if not sys.stdin.isatty():
        return sys.stdin.readline().rstrip("\r\n")
    secret = getpass.getpass(f"Secret of {name}: ")
    check_secret(secret)
    if getpass.getpass("The same again: ") != secret:
        raise PeopleError("the two secrets are not the same; try again")
    return secret
