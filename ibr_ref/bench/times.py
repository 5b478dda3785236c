"""How frames are timed."""

from __future__ import annotations

import time
from collections.abc import Callable


def best_and_median(frame: Callable[[], object], repeat: int) -> tuple[float, float]:
    """Seconds of one call, after one that warms up."""
    frame()
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        frame()
        times.append(time.perf_counter() - start)
    times.sort()
    return times[0], times[len(times) // 2]
