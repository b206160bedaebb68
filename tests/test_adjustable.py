"""Laws of the settings that are changed on the page: in range or not at all, and back where they came from."""

from dataclasses import fields, replace
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.adjustable import DECIDING, KEYS, MEASURED, METHOD, NUMBERS, Adjustable, Chosen, with_value
from app.deciding.events import ControlTaken, PageCame
from app.deciding.settings import DecisionSettings
from app.events import PointerDragged, Reconstructed, Refused, SettingTyped, UnitChosen
from app.session import Done, Session, step
from rotrecon.settings import Settings
from tests.deciding.desk import ANN, BOB, Table

numbers = pytest.mark.parametrize("one", NUMBERS.values(), ids=lambda one: one.key)
SESSION = Session((640, 480))


@numbers
def test_a_default_is_in_its_range_and_both_ends_are_taken(one: Adjustable) -> None:
    owner = Settings if one.key in MEASURED else DecisionSettings
    assert one.key in {field.name for field in fields(owner)}
    default = Chosen()[one.key]
    assert one.low <= one.shown(default) <= one.high
    assert with_value(Chosen(), one.key, default) == Chosen()
    for end in (one.low, one.high):
        changed = with_value(Chosen(), one.key, one.setting(end))
        assert changed is not None
        assert one.shown(changed[one.key]) == end
        assert type(changed[one.key]) is type(default)


@numbers
def test_what_is_out_of_range_or_no_number_is_not_taken(one: Adjustable) -> None:
    outside = (one.low - one.step, one.high + one.step, nan, inf, -inf)
    assert all(with_value(Chosen(), one.key, one.setting(value)) is None for value in outside)
    assert with_value(Chosen(), one.key, "3") is None


def test_a_whole_number_is_the_same_setting_as_that_number_with_a_point() -> None:
    for key, value in (("sigma_factor", 3), ("arm_s", 20)):
        one, other = with_value(Chosen(), key, value), with_value(Chosen(), key, float(value))
        assert one is not None
        assert other is not None
        assert repr(one) == repr(other)


def test_no_other_setting_can_be_changed_and_no_layer_halved() -> None:
    assert with_value(Chosen(), "hold_s", 0.1) is None
    assert with_value(Chosen(), "nonsense", 1.0) is None
    assert with_value(Chosen(), METHOD, "guess") is None
    assert with_value(Chosen(), "layers", 2.5) is None


@given(st.sampled_from([*NUMBERS.values()]), st.floats(0, 1))
def test_a_number_comes_back_as_it_was_typed(one: Adjustable, share: float) -> None:
    typed = round((one.low + share * (one.high - one.low)) / one.step) * one.step
    typed = round(min(max(typed, one.low), one.high), 6)
    assert one.shown(one.setting(typed)) == typed


@given(st.lists(st.tuples(st.sampled_from([*KEYS, "hold_s"]), st.floats(0, 1000) | st.sampled_from(["paper", nan]))))
def test_every_change_of_a_measuring_setting_is_another_revision(typed: list[tuple[str, float | str]]) -> None:
    session = SESSION
    for key, value in typed:
        after = step(session, SettingTyped(key, value))
        assert (after.revision > session.revision) == (after.settings != session.settings)
        assert after.decision.settings.hold_s == DecisionSettings().hold_s
        session = after


def test_only_the_one_in_control_changes_a_setting() -> None:
    session = step(step(SESSION, PageCame(0.0, ANN, "Ann")), PageCame(0.0, BOB, "Bob"))
    session = step(session, ControlTaken(0.0, ANN))
    for event in (SettingTyped("layers", 3), SettingTyped("arm_s", 20.0), UnitChosen("inch")):
        watching = step(session, Done(BOB, event))
        assert (watching.chosen, watching.unit) == (session.chosen, session.unit)
        assert watching.decision.said
    session = step(session, Done(ANN, SettingTyped("layers", 3)))
    assert (session.settings.layers, session.defaults.measuring.layers) == (3, 2)


def test_a_changed_setting_is_measured_anew_and_voids_the_proposal() -> None:
    table = Table()
    session = replace(SESSION, decision=table.deciding)
    session = step(session, PointerDragged((100.0, 100.0), (200.0, 300.0)))
    session = step(session, Reconstructed(session.revision, Refused("too thin")))
    assert session.up_to_date
    assert table.deciding.case is not None
    offer = replace(table.deciding.case.offer, revision=session.revision)
    session = replace(session, decision=replace(table.deciding, case=replace(table.deciding.case, offer=offer)))
    after = step(session, SettingTyped("rod_diameter_m", 0.02))
    assert not after.up_to_date
    assert after.decision.case is None
    assert after.decision.outbox[-1].kind == "voided"
    assert step(session, UnitChosen("inch")).decision.case is not None


@pytest.mark.parametrize("one", DECIDING, ids=lambda one: one.key)
def test_what_was_armed_or_confirmed_under_another_time_is_so_no_more(one: Adjustable) -> None:
    for confirm in (False, True):
        table = Table()
        table.arm()
        if confirm:
            table.hold()
        session = replace(SESSION, decision=table.deciding)
        after = step(session, SettingTyped(one.key, one.setting(one.high))).decision
        assert after.case is not None
        assert type(after.case.stage).__name__ == "Proposed"
        assert after.case.number > table.number
        assert not after.case.ready
        assert after.outbox[-1].kind == "voided"
