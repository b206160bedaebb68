"""Who may come in: names, roles and hashed secrets, in one file that only its owner can read."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Literal, get_args

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError

from app.record.store import data_folder
from rotrecon.files import write_whole

Role = Literal["operator", "watcher", "robot"]
ROLES: tuple[Role, ...] = get_args(Role)
LONGEST_NAME = 64
SHORTEST_SECRET = 10
"""Characters: with argon2's cost of some 50 ms a guess, more than anybody tries at a log-in page."""
LONGEST_SECRET = 1024
PRIVATE = 0o600
HASHER = PasswordHasher()


class PeopleError(Exception):
    """A user who cannot be, or a file of users that cannot be used; the message says what to do."""


@dataclass(frozen=True)
class Person:
    """One who may come in."""

    role: Role
    secret_hash: str
    """Argon2id, with its own parameters and salt."""


@dataclass(frozen=True)
class Visitor:
    """Somebody who has proved who they are."""

    name: str
    role: Role


def people_file(data: Path | None) -> Path:
    """The file of people in a folder of data, or in the user's own."""
    return (data or data_folder()) / "users.json"


def read_people(path: Path) -> Mapping[str, Person]:
    """Everybody in the file, by name; nobody when there is no file. Raises PeopleError naming file and remedy."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        people = {str(name): Person(entry["role"], str(entry["secret_hash"])) for name, entry in content.items()}
    except FileNotFoundError:
        return MappingProxyType({})
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise PeopleError(
            f"{path}: cannot be read as a list of users ({error}); remove it and add them anew"
        ) from error
    for name, person in people.items():
        if person.role not in ROLES:
            raise PeopleError(f"{path}: {name} has the role {person.role!r}; it has to be one of {', '.join(ROLES)}")
    return MappingProxyType(people)


def with_person(people: Mapping[str, Person], name: str, role: Role, secret: str) -> Mapping[str, Person]:
    """The people with one more, or with another secret for one who is there. Raises PeopleError with what to do."""
    check_name(name)
    check_secret(secret)
    return MappingProxyType({**people, name: Person(role, HASHER.hash(secret))})


def check_name(name: str) -> None:
    """Raise PeopleError for what cannot be a name."""
    if not name or len(name) > LONGEST_NAME or not name.isprintable() or ":" in name or name != name.strip():
        raise PeopleError(f"{name!r} cannot be a name; use up to {LONGEST_NAME} printable characters without a colon")


def check_secret(secret: str) -> None:
    """Raise PeopleError for what cannot be a secret."""
    if not SHORTEST_SECRET <= len(secret) <= LONGEST_SECRET:
        raise PeopleError(f"the secret has {len(secret)} characters; use {SHORTEST_SECRET} to {LONGEST_SECRET}")


def write_people(path: Path, people: Mapping[str, Person]) -> None:
    """Write the file whole or not at all, readable by its owner only. Raises PeopleError with what to do."""
    content = json.dumps({name: asdict(person) for name, person in people.items()}, indent=2, ensure_ascii=False)
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        write_whole(path, f"{content}\n".encode(), PRIVATE)
    except OSError as error:
        raise PeopleError(f"{path}: cannot be written ({error.strerror}); choose another folder with --data") from error


def visitor_with(people: Mapping[str, Person], name: str, secret: str) -> Visitor | None:
    """The person of that name if the secret is theirs; takes as long for a name that is not there."""
    person = people.get(name)
    try:
        HASHER.verify(person.secret_hash if person else _nobodys_hash(), secret[:LONGEST_SECRET])
    except (VerificationError, InvalidHashError):
        return None
    return Visitor(name, person.role) if person else None


@cache
def _nobodys_hash() -> str:
    """Checked against for a name that is not there, so that it takes as long as a wrong secret."""
    return HASHER.hash("a secret that is thrown away")
