"""The record looked through: newest first, found by kind and words, nothing told that has to be named first."""

import asyncio
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.archive import VEILED, Archive, Exported, Fetched, Listed, Posted, Told
from app.browsing import Asked, Browsing, EntryChosen, ListFiltered, ListTurned, OpeningAsked, ReplayAsked, ReportAsked
from app.deciding.events import ControlTaken, PageCame
from app.deciding.watchdog import FrameFacts
from app.held import Held
from app.history_text import entry_html, head_html, list_html
from app.newer_frames import facts_of
from app.object_drawing import ObjectDrawing, drawn_as
from app.page import PageState, page_step
from app.record import history
from app.record.entries import Entry, EntryKind
from app.record.evidence import proposal
from app.record.history import LINES, History, Line, Listing, Wanted
from app.record.store import Record
from app.reopening import BroughtBack, OpenedAgain
from app.session import Session, step
from rotrecon.camera import PinholeCamera
from rotrecon.capture import Capture
from rotrecon.drawing import AreaOfInterest
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import simulate
from tests.deciding.desk import ANN, BOB, WALL_S, Table

EVIL = "<script>alert(1)</script>"
PAGE = 7


@pytest.fixture(scope="module")
def result() -> Reconstruction:
    camera = PinholeCamera(320, 240, np.array([[300.0, 0, 165.0], [0, 301.0, 117.0], [0, 0, 1]]))
    scene = simulate("pipe", 3, camera, None, supersampling=1)
    return reconstruct(scene.frame, scene.drawing, Settings())


@pytest.fixture(scope="module")
def record(result: Reconstruction, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Record]:
    """A proposal, what was done with it, and 9 entries about nothing."""
    with closing(Record.open(tmp_path_factory.mktemp("record"))) as record:
        written = record.append(
            proposal("Ann", result.frame, result.drawing, result.settings, result), result.frame
        ).content
        about = {"tool": "mechanical cutter"}
        record.append(Entry("armed", "Ann", written["digest"], about))
        record.append(Entry("confirmed", "Ann", written["digest"], about))
        record.append(Entry("rejected", EVIL, written["digest"], {**about, "reason": "the cable is live"}))
        for number in range(9):
            record.append(Entry("declined", f"Bob {number}", payload={"action": "arm", "reason": "not in control"}))
        yield record


@pytest.fixture
def read(record: Record) -> History:
    return History(record)


def numbers(listing: Listing) -> list[int]:
    return [line.number for line in listing.lines]


def all_pages(read: History, wanted: Wanted) -> list[int]:
    """What is found by going on as long as there is more."""
    found, listing = list[int](), read.listing(wanted)
    while True:
        assert len(listing.lines) <= LINES
        found += numbers(listing)
        if listing.older is None:
            return found
        listing = read.listing(replace(wanted, before=listing.older))


@pytest.mark.parametrize("searched", [1, 3, 1000])
@pytest.mark.parametrize("text", ["", "ann", "ANN confirmed", "bob 4", "nobody at all"])
@pytest.mark.parametrize("kinds", [(), ("confirmed", "rejected"), ("declined",)])
def test_going_on_finds_every_entry_once_newest_first(
    read: History, record: Record, kinds: tuple[EntryKind, ...], text: str, searched: int, monkeypatch
) -> None:
    monkeypatch.setattr(history, "SEARCHED", searched)
    words = text.casefold().split()
    expected = [
        entry.id
        for entry in reversed(record.entries())
        if (not kinds or entry.content["kind"] in kinds) and all(word in read.line(entry.id).text for word in words)
    ]
    assert all_pages(read, Wanted(kinds, text)) == expected


def test_what_was_decided_is_shown_with_what_was_measured(read: History, result: Reconstruction) -> None:
    rejected, confirmed = read.listing(Wanted(("confirmed", "rejected"), chosen=3)).lines
    assert confirmed.answer is not None
    assert confirmed.answer["diameter_mm"] == pytest.approx(2000 * float(result.solid.radius_at(0.0)), abs=0.01)  # type: ignore[union-attr]
    assert (confirmed.tool, confirmed.who) == ("mechanical cutter", "Ann")
    assert confirmed.picture == rejected.picture
    assert (confirmed.picture or "").startswith("data:image/jpeg")
    html = list_html(read.listing(Wanted(("confirmed", "rejected"), chosen=3)), None)
    assert html.index("4 rejected") < html.index("3 confirmed")
    assert "the cable is live" in html
    assert "±" in html
    assert "mechanical cutter" in html
    assert EVIL not in html
    assert 'rr-chosen" data-entry="3"' in html


def test_nothing_measured_is_told_before_the_class_is_named(read: History) -> None:
    proposed = read.line(1, veiled=True)
    assert (proposed.answer, proposed.picture, proposed.tool) == (None, None, None)
    assert read.line(1).answer is not None
    assert read.line(3, veiled=True).answer is not None, "that was named before it was confirmed"
    assert all_pages(read, Wanted((), "cylinder")) == [4, 3, 2, 1]
    assert all_pages(read, Wanted((), "cylinder", veiled=True)) == [3], "nor can it be searched for"


def test_the_list_of_an_empty_or_missing_record(tmp_path: Path) -> None:
    with closing(Record.read(tmp_path)) as nothing:
        listing = History(nothing).listing(Wanted(chosen=12))
    assert listing == Listing()
    assert "Nothing of that kind" in list_html(listing, None)
    assert "it is broken" in list_html(listing, "it is broken")
    assert str(listing.head) in head_html(listing.head)
    assert "Choose an entry" in entry_html(None, "", False)
    told = entry_html(Line(3, "confirmed", EVIL, "2026-01-01T00:00:00"), "2 of 3 numbers are not the same", False)
    assert 'data-same="false"' in told
    assert EVIL not in told


def test_a_page_filters_turns_and_chooses() -> None:
    def browsed(*events: ListFiltered | ListTurned | EntryChosen) -> Browsing:
        page = PageState()
        for event in events:
            page = page_step(page, event, 0)
        return page.browsing

    assert browsed(ListTurned(20), ListTurned(10), ListTurned(None)).before == (20,)
    assert browsed(ListTurned(20), ListTurned(30)).before == (20,), "the list only goes back in time"
    assert browsed(ListTurned(None)) == Browsing()
    assert browsed(ListTurned(20), ListFiltered(text="cutter")) == Browsing(text="cutter")
    assert browsed(ListFiltered(text="x"), ListFiltered(shown="armed")) == Browsing("armed", "x")
    assert browsed(ListFiltered(shown="nonsense")) == Browsing()
    assert browsed(EntryChosen(4)).chosen == 4


def asked(record: Record | None, *events: Asked, veiled: bool = False) -> list[Posted]:
    """What an archive posts."""

    async def run() -> list[Posted]:
        posted: list[Posted] = []
        archive = Archive(record, posted.append)
        for event in events:
            archive.ask(PAGE, event, veiled)
        while archive.busy:
            await asyncio.sleep(0)
        return posted

    return asyncio.run(run())


def test_an_entry_is_computed_again_saved_and_fetched(record: Record, result: Reconstruction) -> None:
    (told,) = asked(record, ReplayAsked(3))
    assert isinstance(told, Told)
    assert told.good
    assert "numbers are the same" in told.text
    (report,) = asked(record, ReportAsked(3, "html"))
    assert isinstance(report, Exported)
    assert report.name == "rotrecon-3.html"
    assert b"Confirmed" in report.content
    (fetched,) = asked(record, OpeningAsked(3))
    assert isinstance(fetched, Fetched)
    assert np.array_equal(fetched.held.frame.points_m, result.frame.points_m, equal_nan=True)
    assert fetched.drawn.complete == result.drawing
    assert fetched.held.entry == 3


def test_what_cannot_be_done_with_an_entry_is_said(record: Record, result: Reconstruction) -> None:
    for events, why in (
        ((ReplayAsked(99),), "there is no entry 99"),
        ((OpeningAsked(5),), "is about no measurement"),
        ((ReplayAsked(3), ReplayAsked(3)), "One thing after the other"),
    ):
        first, *_ = asked(record, *events)
        assert isinstance(first, Told)
        assert why in first.text
        assert not first.good
    (veiled,) = asked(record, OpeningAsked(1), veiled=True)
    assert veiled == Told((PAGE,), 1, VEILED)
    (none,) = asked(None, ReplayAsked(1))
    assert isinstance(none, Told)
    assert "without a record" in none.text


def test_a_list_is_read_again_a_second_after_something_was_written(record: Record, result: Reconstruction) -> None:
    async def run() -> list[Posted]:
        posted: list[Posted] = []
        archive = Archive(record, posted.append)
        everything = Browsing("everything")
        for now, written, browsing in (
            (10.0, 0, Browsing()),
            (11.0, 0, Browsing()),
            (12.0, 1, Browsing()),
            (12.9, 1, Browsing()),
            (13.1, 1, Browsing()),
            (14.0, 1, everything),
        ):
            archive.look({PAGE: browsing, PAGE + 1: browsing}, written, False, now)
            while archive.busy:
                await asyncio.sleep(0)
        return posted

    found = asyncio.run(run())
    lists = [item for item in found if isinstance(item, Listed)]
    assert [numbers(item.listing) for item in lists] == [[4, 3], [4, 3], [13, 12, 11, 10, 9]]
    assert all(item.pages == (PAGE, PAGE + 1) for item in lists), "once for all who want to see the same"


AREA = AreaOfInterest.rectangle((10.0, 10.0), (90.0, 60.0))
MM = st.integers(0, 50_000).map(lambda count: count / 100)


@given(MM, MM, st.sampled_from(["free", "vertical"]), st.frozensets(st.integers(0, 90)))
def test_a_recorded_drawing_is_drawn_again_exactly(low, high, direction, excluded) -> None:
    drawing = ObjectDrawing(AREA, None, "rod", excluded, (low, high), direction).complete
    assert drawing is not None
    assert drawn_as(drawing).complete == drawing


def opened_again(result: Reconstruction, page: int, at: float) -> OpenedAgain:
    held = Held(result.frame, "entry 3", Capture("entry 3", recorded=result.frame), entry=3)
    return OpenedAgain(at, page, WALL_S, facts_of(result.frame), held, drawn_as(result.drawing))


def test_opening_again_begins_anew_on_another_frame_and_nothing_stays_armed(result: Reconstruction) -> None:
    table = Table()
    table.arm()
    session = Session((640, 480), (ObjectDrawing(AREA),), past=((ObjectDrawing(),),), decision=table.deciding)
    refused = step(session, opened_again(result, BOB, table.now))
    assert refused.objects == session.objects
    assert "Ann is in control" in refused.decision.said[0].text
    after = step(session, opened_again(result, ANN, table.later(5.0)))
    assert after.size_px == (320, 240)
    assert after.shown.complete == result.drawing
    assert (after.past, after.future, after.entry) == ((), (), 3)
    assert after.decision.case is None
    assert after.decision.armed is None
    assert [entry.kind for entry in after.decision.outbox] == ["voided"]
    assert not after.up_to_date, "it is measured again before anything is proposed"
    watched = after.decision.watched
    assert watched is not None
    assert (watched.held.source, watched.opened, watched.age_s) == ("recorded", table.now, 0.0)


def test_a_page_without_control_opens_nothing(result: Reconstruction) -> None:
    session = step(Session((640, 480)), PageCame(1.0, ANN, "Ann"))
    assert step(session, opened_again(result, ANN, 2.0)).entry is None
    session = step(session, ControlTaken(3.0, ANN))
    assert step(session, opened_again(result, ANN, 4.0)).entry == 3


def test_the_way_back_leads_to_frame_and_drawings_as_they_were_and_not_to_what_was_armed(
    result: Reconstruction,
) -> None:
    live = FrameFacts("pixels", "live", captured_s=WALL_S - 30)
    table = Table(frame=live)
    table.arm()
    before = Held(replace(result.frame), "the cell", Capture("the cell", recorded=result.frame))
    drawn = (ObjectDrawing(AREA), ObjectDrawing())
    session = Session(before.size_px, drawn, held=before, decision=table.deciding)
    nowhere = step(session, BroughtBack(table.now, ANN, WALL_S))
    assert nowhere.held is before
    assert "nothing to go back to" in nowhere.decision.said[0].text
    for entry in (3, 3):
        session = step(session, opened_again(result, ANN, table.later(1.0)))
        assert session.entry == entry
    refused = step(session, BroughtBack(table.now, BOB, WALL_S))
    assert refused.entry == 3
    after = step(session, BroughtBack(table.later(8.0), ANN, WALL_S + 10))
    assert after.held is before
    assert (after.objects, after.left, after.decision.case) == (drawn, None, None)
    watched = after.decision.watched
    assert watched is not None
    assert (watched.held, watched.age_s) == (live, 40.0), "a live frame has grown older meanwhile"
