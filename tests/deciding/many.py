"""Ten thousand sequences of events; `make test` runs some of them: .venv/bin/python -m tests.deciding.many"""

import sys
from collections import Counter

from hypothesis import HealthCheck, settings
from hypothesis.stateful import run_state_machine_as_test

from tests.deciding.test_machine import Machine

SEQUENCES = 10_000
seen: Counter[str] = Counter()


class Counted(Machine):
    def teardown(self) -> None:
        seen["sequences"] += 1
        seen["with a confirmation"] += bool(getattr(self, "confirmed", 0))
        seen["confirmations"] += getattr(self, "confirmed", 0)


def main() -> None:
    run_state_machine_as_test(
        Counted,
        settings=settings(
            max_examples=SEQUENCES,
            stateful_step_count=40,
            deadline=None,
            database=None,
            suppress_health_check=list(HealthCheck),
        ),
    )
    sys.stdout.write(", ".join(f"{count} {what}" for what, count in seen.items()) + "; no rule was broken\n")


if __name__ == "__main__":
    main()
