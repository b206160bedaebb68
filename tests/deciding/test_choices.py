"""What the operator chooses and types: a rejection, another tool, the class of what is dangerous."""

from app.deciding.events import (
    ClassNamed,
    OverrideDropped,
    OverrideTyped,
    RejectPressed,
)
from app.deciding.settings import DecisionSettings
from app.deciding.states import obstacles
from tests.deciding.desk import ANN, WHY, Table, offer

DANGEROUS = DecisionSettings(dangerous=frozenset({"cylinder"}))


def test_a_rejection_takes_a_reason_and_is_final_until_the_drawing_changes(table: Table) -> None:
    table.do(RejectPressed(table.now, ANN, table.number, "  no  "))
    assert table.state == "proposed"
    table.do(RejectPressed(table.now, ANN, table.number, WHY))
    assert table.state == "rejected"
    assert table.written[-1].payload["reason"] == WHY
    table.arm()
    table.hold()
    assert table.state == "rejected"


def test_what_was_confirmed_can_be_withdrawn(table: Table) -> None:
    table.arm()
    table.hold()
    table.do(RejectPressed(table.now, ANN, table.number, WHY))
    assert table.state == "rejected"


def test_an_override_takes_a_typed_reason_and_the_same_two_actions(table: Table) -> None:
    for tool, reason in (("clipper", ""), ("clipper", " . . "), ("hammer", WHY), ("cutter", WHY)):
        table.do(OverrideTyped(table.now, ANN, table.number, tool, reason))
        assert table.deciding.case is not None
        assert table.deciding.case.override is None
    table.do(OverrideTyped(table.now, ANN, table.number, "clipper", WHY))
    assert table.state == "proposed"
    table.arm()
    table.hold()
    assert table.kinds[-1] == "overridden"
    assert table.written[-1].payload["tool"] == "clipper"
    assert table.written[-1].payload["override"] == WHY


def test_a_tool_with_something_in_its_way_is_armed_only_by_an_override_that_says_so() -> None:
    hit = "At the object it would hit 3 points of the cloud."
    table = Table(offer=offer("digest 0", in_the_way={"cutter": (hit,)}))
    table.arm()
    assert table.state == "proposed"
    assert table.said_to(ANN) == hit
    assert obstacles(table.deciding)[-1].startswith("Turn the approach or move the contact")
    table.do(OverrideTyped(table.now, ANN, table.number, "cutter", "   "))
    table.arm()
    assert table.state == "proposed", "without a reason it is none"
    table.do(OverrideTyped(table.now, ANN, table.number, "cutter", "that is a loose cable, it gives way"))
    table.arm()
    table.hold()
    assert table.kinds[-1] == "overridden"
    assert table.written[-1].payload["in_the_way"] == hit
    assert table.written[-1].payload["tool"] == "cutter"


def test_what_is_in_the_way_of_another_tool_blocks_nothing() -> None:
    table = Table(offer=offer("digest 0", in_the_way={"clipper": ("It would hit something.",)}))
    assert obstacles(table.deciding) == ()
    assert table.deciding.case is not None
    assert table.deciding.case.offer.choices == ("clipper", "grip")


def test_choosing_another_tool_disarms(table: Table) -> None:
    table.arm()
    table.do(OverrideTyped(table.now, ANN, table.number, "clipper", WHY))
    assert table.state == "proposed"
    table.arm()
    table.do(OverrideDropped(table.now, ANN, table.number))
    assert table.state == "proposed"


def test_without_a_tool_only_an_override_can_be_confirmed() -> None:
    table = Table(offer=offer("thin", tool=None))
    table.arm()
    table.hold()
    assert table.state == "proposed"
    table.do(OverrideTyped(table.now, ANN, table.number, "cutter", WHY))
    table.arm()
    table.hold()
    assert table.kinds[-1] == "overridden"


def test_a_dangerous_class_is_named_before_it_is_shown_and_a_disagreement_blocks() -> None:
    table = Table(DANGEROUS, offer("d", tool="grip"))
    assert table.deciding.veiled
    table.arm()
    assert table.state == "proposed"
    table.do(ClassNamed(table.now, ANN, table.number, "sphere"))
    assert not table.deciding.veiled
    table.arm()
    assert "You named a sphere" in table.said_to(ANN)
    table.do(ClassNamed(table.now, ANN, table.number, "cylinder"))
    table.arm()
    assert table.state == "proposed", "it is named once"
    table.propose(offer("d2", tool="grip"))
    table.do(ClassNamed(table.now, ANN, table.number, "cylinder"))
    table.arm()
    table.hold()
    assert table.state == "decided"
    assert table.written[-1].payload["named"] == "cylinder"


def test_a_tool_that_is_not_for_dangerous_classes_is_not_put_to_one() -> None:
    table = Table(DANGEROUS)
    table.do(ClassNamed(table.now, ANN, table.number, "cylinder"))
    table.arm()
    assert table.state == "proposed"
    assert "may not be put" in table.said_to(ANN)


def test_a_disagreement_about_harmless_classes_blocks_nothing() -> None:
    table = Table(DANGEROUS, offer("d", kind="cone"))
    table.do(ClassNamed(table.now, ANN, table.number, "sphere"))
    table.arm()
    assert table.state == "armed"
