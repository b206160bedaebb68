"""What is kept of a session from one start of the program to the next: the drawings and the settings of a scene."""

import hashlib
import logging
from dataclasses import dataclass, field, replace
from pathlib import Path

import msgspec

from app.adjustable import KEYS, Value, with_value
from app.digest import frame_id
from app.events import SettingTyped
from app.object_drawing import ObjectDrawing, on_frame
from app.session_state import Session
from app.setting_steps import set_to
from app.units import Unit
from rotrecon.files import flush_folder, write_whole
from rotrecon.frame import Frame

FOLDER = "sessions"
"""In the data folder; a file a scene, named by what its frame holds."""
FORMAT = 1
LEAST_CORNERS = 3
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Kept:
    """Nothing of who is in control, and nothing that was proposed, armed or decided."""

    objects: tuple[ObjectDrawing, ...] = (ObjectDrawing(),)
    selected: int = 0
    settings: dict[str, Value] = field(default_factory=dict)
    """Those that are not as the program was started with, by their keys."""
    unit: Unit = "mm"
    format: int = FORMAT


def kept_of(session: Session) -> Kept:
    """What there is to keep; a drag or a polygon that has not ended is not."""
    chosen, defaults = session.chosen, session.defaults
    changed = {key: chosen[key] for key in KEYS if chosen[key] != defaults[key]}
    return Kept(session.objects, session.selected, changed, session.unit)


def resumed(session: Session, kept: Kept) -> Session:
    """A session that has just begun, with what was kept of an earlier one; raises ValueError for what cannot be one."""
    if kept.format != FORMAT or not 0 <= kept.selected < len(kept.objects):
        raise ValueError("it is not of this version of the program")
    for drawn in kept.objects:
        _check(drawn, session.size_px)
    for key, value in kept.settings.items():
        if with_value(session.chosen, key, value) is None:
            raise ValueError(f"{key} cannot be {value}")
        session = set_to(session, SettingTyped(key, value))
    return replace(session, objects=kept.objects, selected=kept.selected, unit=kept.unit)


def _check(drawn: ObjectDrawing, size_px: tuple[int, int]) -> None:
    """Raise ValueError for a drawing that was not made on a frame of that size."""
    places = [] if drawn.area is None else [*drawn.area.vertices_px]
    if drawn.area is not None and len(places) < LEAST_CORNERS:
        raise ValueError("an area has too few corners")
    if drawn.axis is not None:
        places += [drawn.axis.start_px, drawn.axis.end_px]
    if any(on_frame(place, size_px) != place for place in places):
        raise ValueError("a drawing is not on the frame")


class LastSessions:
    """The files of sessions: a line with the hash of the rest, then JSON. Not for two threads at once."""

    def __init__(self, folder: Path) -> None:
        """In the data folder `folder`."""
        self._folder = folder / FOLDER
        self._kept: tuple[Path | None, Kept] = (None, Kept())
        self.problem: str | None = None
        """What a person should know of these files, in one sentence."""

    def path(self, frame: Frame) -> Path:
        """The file of the session on a frame, which is known by what it holds."""
        return self._folder / f"{frame_id(frame)}.json"

    def resumed(self, session: Session) -> Session:
        """A session that has just begun, with what was kept; a file that cannot be used is moved aside, and told of."""
        if session.held is None:
            return session
        path = self.path(session.held.frame)
        self._kept = (path, Kept())
        try:
            kept = _read(path.read_bytes())
            session = resumed(session, kept)
        except FileNotFoundError:
            return session
        except OSError as error:
            self.problem = f"The last session cannot be read ({error.strerror}): {path}."
        except ValueError as error:
            self.problem = f"The last session of this scene is damaged ({error}), and is left aside in {_aside(path)}."
        else:
            self._kept = (path, kept)
        return session

    def keep(self, session: Session) -> None:
        """Put what is new on disk; what the disk refuses is told of once, and tried again."""
        if session.held is None:
            return
        path, kept = self.path(session.held.frame), kept_of(session)
        if (path, kept) == self._kept:
            return
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            write_whole(path, _written(kept))
            self._kept, self.problem = (path, kept), None
        except OSError as error:
            problem = f"This session is not kept ({error.strerror}): {path}."
            if problem != self.problem:
                log.warning(problem)
            self.problem = problem


def _aside(path: Path) -> Path:
    """Where a file was moved that must not be written over."""
    aside = path.with_suffix(".damaged")
    try:
        path.replace(aside)
        flush_folder(aside.parent)
    except OSError:
        return path
    return aside


def _written(kept: Kept) -> bytes:
    content = msgspec.json.encode(kept)
    return b"\n".join((hashlib.sha256(content).hexdigest().encode(), content))


def _read(raw: bytes) -> Kept:
    """What is in a file; raises ValueError."""
    digits, _, content = raw.partition(b"\n")
    if hashlib.sha256(content).hexdigest().encode() != digits:
        raise ValueError("it is not as it was written")
    return msgspec.json.decode(content, type=Kept)
