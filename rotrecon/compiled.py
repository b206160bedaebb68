"""Loops over many rays or pixels, compiled by Numba: an operation of numpy on so few numbers is mostly its overhead."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba  # pyright: ignore[reportMissingTypeStubs]

NUMBA = cast(Any, numba)
"""It comes without types."""
FLOAT, FLAG, COUNT = NUMBA.float64, NUMBA.boolean, NUMBA.int64
VECTOR = NUMBA.types.Array(NUMBA.float64, 1, "C", readonly=True)
MATRIX = NUMBA.types.Array(NUMBA.float64, 2, "C", readonly=True)
CUBE = NUMBA.types.Array(NUMBA.float64, 3, "C", readonly=True)
"""Arrays without gaps, which the compiled function does not write to."""

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(*arguments: Any) -> Callable[[Function], Function]:
    """Compile a function for arguments of these types, once for all processes to come.

    That takes about half a second a function, and is kept beside the source, or in the user's cache where that cannot
    be written; where nothing can, every process compiles for itself. A division by zero gives inf, as numpy has it.
    """

    def compile_(function: Function) -> Function:
        try:
            return cast(Function, NUMBA.njit([arguments], cache=True, error_model="numpy")(function))
        except RuntimeError:
            return cast(Function, NUMBA.njit([arguments], error_model="numpy")(function))

    return compile_
