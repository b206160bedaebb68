"""The program's own mistakes, logged instead of letting them end what goes on."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager

log = logging.getLogger(__name__)


@contextmanager
def logged(failure: str) -> Iterator[None]:
    """Log a mistake of the program's own instead of letting it end the console."""
    try:
        yield
    except Exception:
        log.exception(failure)
