"""A proposal on the table, as most tests of the decision begin."""

import pytest

from tests.deciding.desk import Table


@pytest.fixture
def table() -> Table:
    return Table()
