"""The answer, worked out once for all that is shown of it."""

from functools import lru_cache
from typing import Any

from rotrecon.answer import answer
from rotrecon.reconstruction import Reconstruction


@lru_cache(maxsize=2)
def answer_of(result: Reconstruction) -> dict[str, Any]:
    """The answer of a reconstruction, as `rotrecon.answer` gives it; not to be changed."""
    return answer(result)
