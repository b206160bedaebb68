"""The controls of the decision on one page: who is in control, naming, arming, holding, rejecting, overriding."""

from collections.abc import Callable
from typing import Any, get_args

from viser import ClientHandle, GuiButtonHandle, GuiDropdownHandle, GuiEvent, GuiTabHandle

from app.clock import seconds, wall_s
from app.deciding.events import (
    ArmPressed,
    ClassNamed,
    ControlAsked,
    ControlGiven,
    ControlTaken,
    DecisionEvent,
    FrameReopened,
    HandoverAnswered,
    HoldTicked,
    OverrideDropped,
    OverrideTyped,
    RejectPressed,
)
from app.deciding.states import Armed, Case, Decided, Deciding, Proposed, Rejected, obstacles
from app.deciding.watchdog import problems
from app.decision_text import control_html, decision_html
from app.session import Session
from app.showing import in_session_unit, set_to
from rotrecon.primitives import Kind

TICKS_HZ = 10.0
"""Of a button that is held."""
CONTROL, DECISION, TWO_ACTIONS, NAMING, REFUSING = range(5)
"""Where the parts stand, whenever they are made: the two buttons are made anew for each proposal."""
CHOOSE = "choose one"
"""What stands where a class has not been named yet."""
STEP = 0.1
"""From one control of a part to the next."""
NOTHING: tuple[str, ...] = ("-",)


class DecisionPanel:
    """One page's; the server judges everything that comes from it, whatever is shown or disabled."""

    def __init__(self, client: ClientHandle, tab: GuiTabHandle, post: Callable[[DecisionEvent], None]) -> None:
        self._gui, self._page, self._tab, self._post = client.gui, client.client_id, tab, post
        self._number = self._shown = self._asked_of = 0
        self._two: tuple[GuiButtonHandle, GuiButtonHandle] | None = None
        with tab:
            self._add_control()
            self._decision = self._gui.add_html("", order=DECISION)
            self._again = self._button(
                "Open the frame again", lambda at: FrameReopened(at, self._page, wall_s()), DECISION + STEP
            )
            self._add_naming()
            self._add_refusing()

    def show(self, session: Session) -> None:
        """Bring this page's controls up to date."""
        deciding = session.decision
        case = deciding.case
        self._shown = 0 if case is None else case.number
        set_to(self._control, "content", control_html(deciding, self._page))
        set_to(self._decision, "content", in_session_unit(decision_html(session), session))
        self._show_control(deciding)
        holds = deciding.control.holder == self._page
        recorded = deciding.watched is not None and deciding.watched.held.source == "recorded"
        stale = bool(problems(deciding.watched, deciding.settings, deciding.now))
        set_to(self._again, "visible", holds and recorded and stale and session.newer is None)
        self._show_naming(holds and case is not None and deciding.veiled)
        self._show_two(deciding, case if holds and not deciding.veiled else None)
        self._show_refusing(deciding, case if holds else None)

    def _show_naming(self, asked: bool) -> None:
        """What it is has to be said anew of each proposal: a class that stands there already would be an answer."""
        if self._shown != self._asked_of:
            self._asked_of = self._shown
            set_to(self._class, "value", CHOOSE)
        set_to(self._name, "disabled", self._class.value == CHOOSE)
        for part in (self._class, self._name):
            set_to(part, "visible", asked)

    def _show_control(self, deciding: Deciding) -> None:
        control = deciding.control
        holds = control.holder == self._page
        set_to(self._take, "visible", control.holder is None)
        set_to(self._give, "visible", holds and control.asked is None)
        set_to(self._ask, "visible", control.holder is not None and not holds and control.asked is None)
        for part in (self._yes, self._no):
            set_to(part, "visible", holds and control.asked is not None)

    def _show_two(self, deciding: Deciding, case: Case | None) -> None:
        """The two buttons of one proposal, made when all that shows it has been sent before them."""
        number = case.number if case is not None and case.ready else 0
        if number != self._number:
            for button in self._two or ():
                button.remove()
            self._number, self._two = number, self._made(number) if number else None
        if self._two is None or case is None:
            return
        arm, hold = self._two
        set_to(arm, "disabled", not isinstance(case.stage, Proposed) or bool(obstacles(deciding)))
        set_to(hold, "disabled", not isinstance(case.stage, Armed))
        word = "override" if case.override is not None else "confirm"
        set_to(hold, "label", f"2. Hold one second to {word}" + (f": {case.tool}" if case.tool else ""))
        for button in self._two:
            set_to(button, "visible", isinstance(case.stage, Proposed | Armed))

    def _show_refusing(self, deciding: Deciding, case: Case | None) -> None:
        open_ = case is not None and not deciding.veiled and not isinstance(case.stage, Rejected)
        set_to(self._refusing, "visible", open_)
        set_to(self._reject, "visible", open_)
        choosing = open_ and case is not None and not isinstance(case.stage, Decided)
        for part in (self._tool, self._override):
            set_to(part, "visible", choosing)
        set_to(self._drop, "visible", choosing and case is not None and case.override is not None)
        if case is not None and choosing:
            options = case.offer.choices or NOTHING
            if self._tool.options != options:
                self._tool.options = options

    def _made(self, number: int) -> tuple[GuiButtonHandle, GuiButtonHandle]:
        with self._tab:
            arm = self._gui.add_button("1. Arm", color="orange", order=TWO_ACTIONS)
            hold = self._gui.add_button("2. Hold", color="red", order=TWO_ACTIONS + STEP)

        async def pressed(event: GuiEvent[Any]) -> None:
            if event.client_id is not None:
                self._post(ArmPressed(seconds(), event.client_id, number))

        async def held(event: GuiEvent[Any]) -> None:
            if event.client_id is not None:
                self._post(HoldTicked(seconds(), event.client_id, number))

        arm.on_click(pressed)
        hold.on_hold(held, callback_hz=TICKS_HZ)
        return arm, hold

    def _add_control(self) -> None:
        page, orders = self._page, [CONTROL + n * STEP for n in range(1, 6)]
        self._control = self._gui.add_html("", order=CONTROL)
        self._take = self._button("Take control", lambda at: ControlTaken(at, page), orders[0], None)
        self._give = self._button("Give control back", lambda at: ControlGiven(at, page), orders[1])
        self._ask = self._button("Ask for control", lambda at: ControlAsked(at, page), orders[2], None)
        self._yes = self._button("Hand it over", lambda at: HandoverAnswered(at, page, True), orders[3], None)
        self._no = self._button("Keep control", lambda at: HandoverAnswered(at, page, False), orders[4])

    def _add_naming(self) -> None:
        kinds: tuple[Kind, ...] = get_args(Kind)
        self._class = self._gui.add_dropdown("The object is a", (CHOOSE, *kinds), visible=False, order=NAMING)

        def named(at: float) -> ClassNamed | None:
            said = self._class.value
            return None if said == CHOOSE else ClassNamed(at, self._page, self._shown, said)

        self._name = self._button("Name it, and see the measurement", named, NAMING + STEP, None)

        async def chosen(_: GuiEvent[Any]) -> None:
            self._name.disabled = self._class.value == CHOOSE

        self._class.on_update(chosen)

    def _add_refusing(self) -> None:
        """Folded away, as it is the rarer way."""
        self._refusing = self._gui.add_folder(
            "Reject or override", visible=False, order=REFUSING, expand_by_default=False
        )
        with self._refusing:
            self._reason = self._gui.add_text("Reason", "", order=0)
            self._reject = self._button(
                "Reject, for that reason", lambda at: RejectPressed(at, self._page, self._shown, self._reason.value), 1
            )
            self._tool: GuiDropdownHandle[str] = self._gui.add_dropdown("With the tool", NOTHING, order=2)
            self._override = self._button(
                "Override, for that reason",
                lambda at: OverrideTyped(at, self._page, self._shown, self._tool.value, self._reason.value),
                3,
            )
            self._drop = self._button(
                "Back to the proposed tool", lambda at: OverrideDropped(at, self._page, self._shown), 4
            )

    def _button(
        self,
        label: str,
        event_of: Callable[[float], DecisionEvent | None],
        order: float,
        color: Any = "gray",
    ) -> GuiButtonHandle:
        button = self._gui.add_button(label, color=color, visible=False, order=order)

        async def clicked(event: GuiEvent[Any]) -> None:
            happened = event_of(seconds())
            if event.client_id == self._page and happened is not None:
                self._post(happened)

        button.on_click(clicked)
        return button
