"""Numbers as all strategies draw them: spread evenly, or special ones that tie with something."""

from __future__ import annotations

from functools import cache
from typing import Any

from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

FINENESS = 2**20
GOLDEN = 648055
"""Golden ratio of `FINENESS`, odd: its multiples spread evenly however unevenly (small numbers first) Hypothesis draws."""


@cache  # Hypothesis takes longer to make a strategy than to draw from it
def real(low: float, high: float, *special: float) -> SearchStrategy[float]:
    """A number spread evenly over [low, high]; one in three is `special`, if there are such."""
    even = st.integers(0, FINENESS).map(lambda k: low + (high - low) * (k * GOLDEN % FINENESS / FINENESS))
    return st.one_of(even, even, st.sampled_from(special)) if special else even


def often(usual: Any, *others: Any) -> SearchStrategy[Any]:
    """The usual value as often as all others together."""
    return st.one_of(st.just(usual), st.sampled_from(others))


def seeds() -> SearchStrategy[int]:
    """Of a random generator, for arrays whose single numbers do not matter."""
    return st.integers(0, 2**16)
