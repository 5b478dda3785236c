"""Where a program is on its way through many lanes, and several of them side by side."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from typing import Any, TypeVar

import numpy as np

from ibr_ref.array_types import Bools, Ints
from ibr_ref.jit import threads

MOST_DECISIONS = 48
"""Open decisions on one path of the program; beyond, the lane is lost."""

Result = TypeVar("Result")


class Run:
    """The lanes of a run, what was decided of them, and the symbols that there are."""

    def __init__(self, names: dict[str, int] | None = None) -> None:
        self.names = names or {}
        """How many symbols of each name there are."""
        self.rows = 0
        """That were run so far, forks and all."""
        self.following = False
        self.positions: dict[Any, Any] | None = None
        """Of texels at a coordinate, where fetches at the same one are at the same position."""
        self.begin(np.zeros(1, np.int64))

    def begin(self, origin: Ints, taken: Any = None, known: Any = None) -> None:
        """Start the program on lanes; `known` outcomes of each are given."""
        count = len(origin)
        self.origin = origin
        self.taken = np.zeros((count, MOST_DECISIONS), np.bool_) if taken is None else taken
        self.known = np.zeros(count, np.int64) if known is None else known
        self.asked = np.zeros(count, np.int64)
        self.lost: Bools = np.zeros(count, np.bool_)
        self.forks: list[tuple[Any, Any, Any]] = []


class Runs:
    """One run at a time, or one in each thread of those that `side_by_side` starts."""

    def __init__(self) -> None:
        self._first, self._own = Run(), threading.local()

    @property
    def run(self) -> Run:
        """Of this thread."""
        return getattr(self._own, "run", self._first)

    def side_by_side(self, jobs: Sequence[Callable[[], Result]]) -> Iterator[Result]:
        """What jobs give that share nothing but the numbers there are now, in their order.

        They run on as many threads as kernels do: most of their time goes into compiled code, beside which Python runs
        another one. Each names its symbols as if it were the only one, so that what it gives does not depend on the others.
        """
        names = self.run.names

        def alone(job: Callable[[], Result]) -> tuple[Result, int]:
            run = self._own.run = Run(dict(names))
            return job(), run.rows

        if min(len(jobs), threads()) < 2:
            for job in jobs:
                yield job()
            return
        with ThreadPoolExecutor(threads()) as pool:
            # In a context like this one: it holds NumPy's error state.
            results = [pool.submit(copy_context().run, alone, job) for job in jobs]
            try:
                for found, rows in (each.result() for each in results):
                    self.run.rows += rows
                    yield found
            finally:
                pool.shutdown(wait=False, cancel_futures=True)
