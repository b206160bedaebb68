"""A console behind the door as `rotrecon serve` opens it, with pages that only the wire knows."""

from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from math import inf
from pathlib import Path
from secrets import token_urlsafe
from tempfile import TemporaryDirectory

from app.bench.poses import CAMERA, STEREO
from app.clock import seconds
from app.console import Console
from app.console_items import FromPage
from app.deciding.events import ControlTaken
from app.deciding.settings import DecisionSettings
from app.door.door import Door
from app.door.hidden_viser import HiddenViser
from app.door.listening import listen
from app.door.people import with_person, write_people
from app.record.store import Record
from app.robot.api import PREFIX, robot_routes
from app.robot.cell import ConsoleCell
from rotrecon.settings import Method, Settings
from rotrecon.simulation.simulate import Simulated, simulate

OBJECT, WATCHER, ROBOT = "leg", "Walt", "arm"
PATIENT = DecisionSettings(silent_s=inf)
"""Pages on the wire do not answer when they are asked whether they are there."""


@dataclass(frozen=True, eq=False)
class Served:
    """What is measured from outside."""

    simulated: Simulated
    console: Console
    door: Door
    secret: str
    """Of the watcher and of the robot."""

    @property
    def cookie(self) -> str:
        """What a page of an operator who has logged in carries."""
        return f"{self.door.gate.cookie}={self.door.gate.passes.issue('bench', by_link=True)}"

    @property
    def watchers_cookie(self) -> str:
        """The same of a watcher."""
        return f"{self.door.gate.cookie}={self.door.gate.passes.issue(WATCHER)}"

    @property
    def interface(self) -> str:
        """Where the robot's side is."""
        return f"{self.door.address}{PREFIX}"

    def give_control(self, client_id: int) -> None:
        """Let a page draw."""
        taken = FromPage(client_id, ControlTaken(seconds(), client_id))
        self.console.server.get_event_loop().call_soon_threadsafe(self.console.post, taken)
        self.console.wait_until_idle()


@contextmanager
def served(method: Method) -> Iterator[Served]:
    """A simulated frame of 1280 x 720 px, served on loopback with a record."""
    simulated = simulate(OBJECT, 0, CAMERA, STEREO, supersampling=1)
    with TemporaryDirectory() as place, closing(Record.open(Path(place))) as record:
        people, hidden = Path(place) / "users.json", HiddenViser()
        secret = token_urlsafe()
        everybody = with_person(with_person({}, WATCHER, "watcher", secret), ROBOT, "robot", secret)
        write_people(people, everybody)
        console = Console(
            simulated.frame,
            OBJECT,
            Settings(method=method),
            open_viser=hidden.open,
            record=record,
            deciding=PATIENT,
            name_of=hidden.name_of,
        )
        console.start()
        bound = listen("127.0.0.1", 0, people, None)
        door = Door(hidden, people, bound, camera_commands=console.panels.camera_commands)
        door.start(robot_routes(ConsoleCell(console), door.gate, door.guard))
        try:
            yield Served(simulated, console, door, secret)
        finally:
            door.stop()
            console.stop()
