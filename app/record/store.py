"""The record on disk: one SQLite database in the user's data folder, or in one that is named."""

import sqlite3
from collections.abc import Collection, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from threading import Lock
from time import monotonic, sleep
from typing import Any

import platformdirs

from app.record.entries import Entry, EntryKind, Head, Written, link
from app.record.errors import NoSuchEntry, StoreError
from app.record.scenes import load_frame, save_frame, scene_problem
from app.record.tree import sha256
from app.record.versions import versions
from rotrecon.files import flush_folder
from rotrecon.frame import Frame

FILE = "record.sqlite3"
BUSY_S = 10.0
"""How long a writer waits for another: writing a frame takes less than one second."""
RETRY_S = 0.01
PAGE = 200
"""Entries that are read at once: some megabytes."""
FORMAT = 1
SCHEMA = f"""
CREATE TABLE IF NOT EXISTS entries (
    id INTEGER PRIMARY KEY, kind TEXT NOT NULL, digest TEXT, body TEXT NOT NULL, hash TEXT NOT NULL
);
CREATE INDEX IF NOT EXISTS entries_by_digest ON entries (digest);
CREATE TABLE IF NOT EXISTS scenes (id TEXT PRIMARY KEY, tree TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS arrays (hash TEXT PRIMARY KEY, content BLOB NOT NULL);
PRAGMA user_version = {FORMAT};
"""


def data_folder() -> Path:
    """The user's own folder for the record, when no other is named."""
    return platformdirs.user_data_path("rotrecon", appauthor=False)


class Record:
    """The record, open; of any number of threads. Every method raises StoreError when the disk does not obey."""

    def __init__(self, folder: Path, connection: sqlite3.Connection) -> None:
        self.folder = folder
        self._connection, self._lock = connection, Lock()

    @staticmethod
    def open(folder: Path | None = None) -> "Record":
        """Open the record of a folder to write to it, and make it where there is none."""
        folder = data_folder() if folder is None else folder
        with _told(folder):
            if not (folder / FILE).exists():
                folder.mkdir(parents=True, exist_ok=True)
                flush_folder(folder.resolve().parent)
            connection = _connected(str(folder / FILE))
            # with both, a commit is on the disk when it returns, and a reader never waits for a writer
            _write_ahead(connection)
            connection.execute("PRAGMA synchronous = FULL")
            if _format_of(connection) == 0:
                connection.executescript(f"BEGIN IMMEDIATE; {SCHEMA} COMMIT;")
                flush_folder(folder)
            record = Record(folder, _checked(connection, folder))
            connection.execute("CREATE INDEX IF NOT EXISTS entries_by_kind ON entries (kind)")
            return record

    @staticmethod
    def read(folder: Path | None = None) -> "Record":
        """Open the record of a folder to read it; where there is none, it is an empty one and nothing is made."""
        folder = data_folder() if folder is None else folder
        with _told(folder):
            file = folder / FILE
            connection = _connected(f"{file.resolve().as_uri()}?mode=ro" if file.exists() else ":memory:", uri=True)
            if _format_of(connection) == 0:
                # none yet, or whoever made it was killed before there was anything in it
                connection.close()
                connection = _connected(":memory:")
                connection.executescript(SCHEMA)
            return Record(folder, _checked(connection, folder))

    def close(self) -> None:
        """Close it; what was appended is on disk already."""
        self._connection.close()

    def append(self, entry: Entry, frame: Frame | None = None) -> Written:
        """Put an entry on disk, and with it a frame that is not there yet; both are, or none, when this returns.

        Raises ValueError for a payload that JSON cannot hold.
        """
        with self._transaction():
            if frame is not None:
                save_frame(self._connection, frame)
            written = link(entry, self._head(), versions())
            row = (written.id, entry.kind, entry.digest, written.body.decode("ascii"), written.hash)
            self._connection.execute("INSERT INTO entries VALUES (?, ?, ?, ?, ?)", row)
            return written

    def entries(
        self, *, kind: EntryKind | None = None, digest: str | None = None, last: int | None = None
    ) -> tuple[Written, ...]:
        """Entries in their order: all, or those of a kind or a digest, and of these at most the `last` ones."""
        where = "WHERE (?1 IS NULL OR kind = ?1) AND (?2 IS NULL OR digest = ?2)"
        query = f"SELECT id, hash, CAST(body AS BLOB) FROM entries {where} ORDER BY id DESC LIMIT ?3"
        rows = self._rows(query, (kind, digest, -1 if last is None else last))
        return tuple(self._written(row) for row in reversed(rows))

    def numbers(self, kinds: Collection[EntryKind] = (), before: int | None = None, most: int = PAGE) -> list[int]:
        """Numbers of entries, the newest first: of some kinds or of all, and older than one of them."""
        marks = f"kind IN ({', '.join('?' * len(kinds))})" if kinds else "TRUE"
        older = "TRUE" if before is None else "id < ?"
        values = (*kinds, *(() if before is None else (before,)), most)
        rows = self._rows(f"SELECT id FROM entries WHERE {marks} AND {older} ORDER BY id DESC LIMIT ?", values)
        return [number for (number,) in rows]

    def entry(self, number: int) -> Written:
        """One entry; raises NoSuchEntry."""
        rows = self._rows("SELECT id, hash, CAST(body AS BLOB) FROM entries WHERE id = ?", (number,))
        if not rows:
            raise NoSuchEntry(f"there is no entry {number} in {self.folder}; `rotrecon log list` shows those there are")
        return self._written(rows[0])

    def scene(self, name: str) -> Frame:
        """A frame by its name (see `app.digest.frame_id`), to the last bit as it was; raises NoSuchEntry."""
        with self._lock, _told(self.folder):
            return load_frame(self._connection, name)

    @property
    def head(self) -> Head:
        """The last entry's number and hash."""
        with self._lock, _told(self.folder):
            return self._head()

    def rows(self) -> Iterator[tuple[Any, ...]]:
        """What the table of entries holds, as bytes, whether it can be read or not: id, kind, digest, body, hash."""
        columns = ", ".join(f"CAST({name} AS BLOB)" for name in ("kind", "digest", "body", "hash"))
        page = self._rows(f"SELECT id, {columns} FROM entries ORDER BY id LIMIT {PAGE}", ())
        while page:
            yield from page
            page = self._rows(f"SELECT id, {columns} FROM entries WHERE id > ? ORDER BY id LIMIT {PAGE}", page[-1][:1])

    def scene_problem(self, name: str) -> str | None:
        """Why a frame cannot be relied on, or None; it need not be one that this version can build."""
        with self._lock, _told(self.folder):
            return scene_problem(self._connection, name)

    def _rows(self, query: str, values: tuple[Any, ...]) -> list[Any]:
        with self._lock, _told(self.folder):
            return self._connection.execute(query, values).fetchall()

    def _written(self, row: tuple[int, str, bytes]) -> Written:
        """An entry as it is read, if it is the one that was written."""
        number, digits, body = row
        if sha256(body) != digits:
            raise StoreError(f"entry {number} of the record in {self.folder} is damaged; restore it from a copy")
        return Written(number, digits, body)

    def _head(self) -> Head:
        row = self._connection.execute("SELECT id, hash FROM entries ORDER BY id DESC LIMIT 1").fetchone()
        return Head() if row is None else Head(*row)

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        """All of what is inside or nothing, after whoever writes now: so the chain has one head."""
        with self._lock, _told(self.folder):
            self._connection.execute("BEGIN IMMEDIATE")
            try:
                yield
                self._connection.execute("COMMIT")
            except BaseException:
                if self._connection.in_transaction:
                    self._connection.execute("ROLLBACK")
                raise


def _connected(path: str, uri: bool = False) -> sqlite3.Connection:
    return sqlite3.connect(path, timeout=BUSY_S, isolation_level=None, check_same_thread=False, uri=uri)


def _write_ahead(connection: sqlite3.Connection) -> None:
    """Switch the journal; when another process is at it too, SQLite refuses at once instead of waiting."""
    end = monotonic() + BUSY_S
    while True:
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            return
        except sqlite3.OperationalError:
            if monotonic() > end:
                raise
            sleep(RETRY_S)


def _format_of(connection: sqlite3.Connection) -> int:
    with closing(connection.execute("PRAGMA user_version")) as found:
        return int(found.fetchone()[0])


def _checked(connection: sqlite3.Connection, folder: Path) -> sqlite3.Connection:
    """A connection to a record of this program's format; raises StoreError."""
    found = _format_of(connection)
    if found != FORMAT:
        connection.close()
        raise StoreError(f"the record in {folder} has format {found}; this version reads {FORMAT}, use another --data")
    return connection


@contextmanager
def _told(folder: Path) -> Iterator[None]:
    """What the disk and the database refuse, as the one error that this is said with."""
    try:
        yield
    except (sqlite3.Error, OSError) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise StoreError(
            f"the record in {folder} cannot be used ({why}); free or mend the disk, or name another folder by --data"
        ) from error
