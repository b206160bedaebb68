"""The benchmarks of the door run, and say what they should; how fast it is, no test says."""

from collections.abc import Iterator

import pytest

from app.bench import crowd
from app.bench.forged import Tried, forge, forged_report
from app.bench.served import Served, served


@pytest.fixture(scope="module")
def house() -> Iterator[Served]:
    with served("paper") as house:
        yield house


def test_every_page_gets_every_release(house: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crowd, "WARM_UP", 0)
    found = crowd.releases(house, 1, pages_open=3)
    assert found.seconds.shape == (1,)
    assert found.seconds[0] > 0
    assert found.bytes[0] > 3 * 10_000


def test_a_thousand_forgeries_are_refused_and_a_message_that_gets_through_is_seen(house: Served) -> None:
    found = forge(house)
    assert [one for one in found if not one.good] == []
    assert sum(one.sent for one in found) == 1000
    assert "MISSED" not in forged_report(found)
    assert "MISSED" in forged_report([*found, Tried("let through", 1, 0, True)])
