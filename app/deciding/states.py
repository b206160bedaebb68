"""What the decision is made of: who is in control, which frame is held, what is proposed, and how far it has got."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from app.deciding.settings import DecisionSettings
from app.deciding.watchdog import Watched, problems
from app.record.entries import Entry
from rotrecon.primitives import Kind, in_words


@dataclass(frozen=True)
class Page:
    """An open page; its number is used once, so a page that comes back is another one."""

    id: int
    name: str
    """Of the person who opened it."""


@dataclass(frozen=True)
class Asked:
    """A page has asked for control, and gets it when the holder has not answered by then."""

    page: int
    until: float


@dataclass(frozen=True)
class Control:
    """The open pages, and which of them is in control."""

    pages: tuple[Page, ...] = ()
    holder: int | None = None
    asked: Asked | None = None
    heard: float = 0.0
    """When the page in control was heard of last."""

    def name(self, page: int | None) -> str:
        """Who is at a page."""
        return next((open_.name for open_ in self.pages if open_.id == page), "nobody")


@dataclass(frozen=True)
class Offer:
    """What came of one drawing, bound to exactly its evidence."""

    revision: int
    """Of the session, whose every change voids it."""
    digest: str
    """Of the evidence, see `app.digest`."""
    kind: Kind
    tool: str | None
    """None where no tool fits."""
    tools: tuple[str, ...] = ()
    """Names of the tool table, which an override chooses from."""
    for_dangerous: frozenset[str] = frozenset()
    """Those that may be put to a class marked dangerous."""
    in_the_way: Mapping[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])
    """Why a tool cannot be at its place, by the names of those of which there is something to say: a sentence each."""

    @property
    def choices(self) -> tuple[str, ...]:
        """Tools that an override may name: the proposed one only where something is in its way."""
        return tuple(tool for tool in self.tools if tool != self.tool or tool in self.in_the_way)


@dataclass(frozen=True)
class Override:
    """The operator's own choice, and why; it takes the same two actions."""

    tool: str
    reason: str


@dataclass(frozen=True)
class Proposed:
    """Nothing was done with it yet."""


@dataclass(frozen=True)
class Armed:
    """The first of two actions was taken."""

    page: int
    since: float
    until: float


@dataclass(frozen=True)
class Decided:
    """Both actions were taken."""

    how: Literal["confirmed", "overridden"]
    who: str
    page: int
    until: float


@dataclass(frozen=True)
class Rejected:
    """The operator will not have it."""

    who: str
    reason: str


Stage = Proposed | Armed | Decided | Rejected


@dataclass(frozen=True)
class Hold:
    """A button that is held, as far as its ticks have come."""

    page: int
    started: float
    last: float
    ticks: int


@dataclass(frozen=True)
class Case:
    """One proposal on its way."""

    number: int
    """Carried by everything that is done with it; never used again."""
    offer: Offer
    ready: bool = False
    """Its pictures have been sent to the page in control: only then it can be armed."""
    named: Kind | None = None
    """The class that the operator named, where that is asked for."""
    override: Override | None = None
    stage: Stage = Proposed()
    hold: Hold | None = None

    @property
    def tool(self) -> str | None:
        """The tool that would be confirmed."""
        return self.offer.tool if self.override is None else self.override.tool

    @property
    def in_the_way(self) -> tuple[str, ...]:
        """Why that tool cannot be at its place: a sentence each, none where nothing was found."""
        return () if self.tool is None else self.offer.in_the_way.get(self.tool, ())


@dataclass(frozen=True)
class Said:
    """Why what was done on a page did nothing, to be told there."""

    page: int
    text: str
    at: float


@dataclass(frozen=True)
class Deciding:
    """The decision as it stands. All times are those of the events, in seconds."""

    settings: DecisionSettings = field(default_factory=DecisionSettings)
    control: Control = Control()
    watched: Watched | None = None
    """The frame that is held."""
    case: Case | None = None
    count: int = 0
    """Proposals so far."""
    outbox: tuple[Entry, ...] = ()
    """To be written before anybody is told of this state."""
    said: tuple[Said, ...] = ()
    """The latest refusal of each page."""
    fault: str | None = None
    """Why the record cannot be written."""
    now: float = 0.0

    @property
    def armed(self) -> Armed | None:
        """How it is armed, if it is."""
        stage = None if self.case is None else self.case.stage
        return stage if isinstance(stage, Armed) else None

    @property
    def veiled(self) -> bool:
        """Whether the operator has to name the class before a result may be seen."""
        return bool(self.settings.dangerous) and (self.case is None or self.case.named is None)


IN_THE_WAY = "Turn the approach or move the contact under \u201cTool\u201d, or override with a reason."
"""What to do about a tool that cannot be at its place."""


def obstacles(deciding: Deciding) -> tuple[str, ...]:
    """Why nothing can be armed or confirmed now, and what to do about it: a sentence each."""
    fault = () if deciding.fault is None else (f"Nothing can be recorded: {deciding.fault}.",)
    return (*fault, *problems(deciding.watched, deciding.settings, deciding.now), *_of_case(deciding))


def _of_case(deciding: Deciding) -> tuple[str, ...]:
    case, dangerous = deciding.case, deciding.settings.dangerous
    if case is None:
        return ("Nothing is proposed: draw an object that can be measured.",)
    if deciding.veiled:
        return ("Name the class of the object first.",)
    found: list[str] = []
    kind, named = case.offer.kind, case.named
    if dangerous and named != kind and {named, kind} & dangerous:
        found.append(
            f"You named a {in_words(named or kind)}, the measurement says {in_words(kind)}, and one of them is "
            "dangerous: look at it from elsewhere and draw it anew."
        )
    if case.tool is None:
        found.append("No tool is proposed: draw it anew, or override with a reason.")
    elif kind in dangerous and case.tool not in case.offer.for_dangerous:
        found.append(f"The {case.tool} may not be put to a {in_words(kind)}, which is marked dangerous.")
    elif case.override is None and case.in_the_way:
        found += [*case.in_the_way, IN_THE_WAY]
    if not case.ready:
        found.append("Its pictures are on their way.")
    return tuple(found)
