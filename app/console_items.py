"""What the console's queue holds."""

from dataclasses import dataclass

from viser import ClientHandle

from app.archive import Exported, Fetched, Listed, Told
from app.browsing import Asked
from app.deciding.events import ClockTicked, DecisionEvent, PageHeard, PicturesSent
from app.desk import Proposable
from app.events import Event, Reconstructed
from app.held import Newer
from app.newer_steps import NewerPrepared, NewerReady, NewerUnusable
from app.page import PageEvent
from app.reopening import BroughtBack


@dataclass(frozen=True)
class PageOpened:
    client: ClientHandle


@dataclass(frozen=True)
class PageClosed:
    client_id: int


@dataclass(frozen=True)
class CameraMoved:
    """A page's camera or canvas has changed; what is shown there may have to be fitted again."""


@dataclass(frozen=True)
class FromPage:
    client_id: int
    event: Event | DecisionEvent | PageEvent | Asked | BroughtBack


@dataclass(frozen=True)
class Stopped:
    """The console is to be closed; whatever else is on the queue is dropped."""


Item = (
    PageOpened
    | PageClosed
    | CameraMoved
    | FromPage
    | Reconstructed
    | Proposable
    | ClockTicked
    | PageHeard
    | PicturesSent
    | Newer
    | NewerPrepared
    | NewerReady
    | NewerUnusable
    | Listed
    | Told
    | Exported
    | Fetched
    | Stopped
)
