"""What is compiled does what its source says, wherever the result can be kept."""

import numpy as np
import pytest
from numba.core import caching

from rotrecon.compiled import FLOAT, VECTOR, compiled


def scaled(values: np.ndarray, by: float) -> np.ndarray:
    return values / by


def test_a_compiled_function_does_not_ask_whether_it_may_write():
    frozen = np.arange(3.0)
    frozen.flags.writeable = False
    function = compiled(VECTOR, FLOAT)(scaled)
    assert function(frozen, 2.0).tolist() == function(np.arange(3.0), 2.0).tolist() == [0.0, 0.5, 1.0]


def test_a_division_by_zero_is_infinite():
    assert compiled(VECTOR, FLOAT)(scaled)(np.ones(1), 0.0).tolist() == [np.inf]


def test_it_compiles_where_nothing_can_be_written(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(caching.CompileResultCacheImpl, "_locator_classes", [])
    assert compiled(VECTOR, FLOAT)(scaled)(np.ones(2), 4.0).tolist() == [0.25, 0.25]
