"""How scenes are drawn by Hypothesis, for all methods: one run for each scene."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis.strategies import SearchStrategy


def run_scene(number: int, cases: SearchStrategy[Any], agree: Callable[[Any], None]) -> None:
    """Draw the simplest case and a random one, and let `agree` compare both.

    Each scene is a run of Hypothesis of its own: within a run it derives five examples from each that it draws, by
    copying numbers about, and most come out as the same picture. `Phase.shrink` is left out to fail fast: add it to
    find the smallest scene that fails.
    """
    chosen = settings(
        max_examples=2,
        derandomize=True,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    seed(number)(chosen(given(case=cases)(agree)))()
