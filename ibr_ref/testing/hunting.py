"""Random cases until the time is up; the first failure of each bug, as small as it gets."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis.database import DirectoryBasedExampleDatabase
from hypothesis.errors import HypothesisException

from ibr_ref.oracle.cases import Case
from ibr_ref.testing.cases import cases
from ibr_ref.testing.judging import Bug, Failure, Port, WrongError, shown, with_causes

ROUND = 200
"""Examples that Hypothesis draws before it starts anew: it derives many of them from the ones before."""

SHRINKING = 20.0
"""Seconds for making one failure smaller, at the most."""


@dataclass(frozen=True, eq=False)
class Found:
    """A bug, on the smallest case that shows it."""

    bug: Bug
    case: Case
    """Named as the bug."""
    after: int
    """Cases that were tried before the first that showed it."""
    seconds: float
    """That had passed then, by the hunt's clock."""
    seed: int
    """Of the round that found it."""


class _TimeIsUp(BaseException):
    """Ends a round; no Exception, which Hypothesis would take for a failure."""


@dataclass
class Hunt:
    """The bugs of one port. Run again with the same seed and the rounds before, it goes on where it stopped."""

    port: Port
    methods: tuple[str, ...]
    system: str | None = None
    """The only one that it draws, of those of its one method: `cases`."""
    device: str | None = None
    """The profile that the port declares."""
    seed: int = 0
    database: Path | None = None
    """Folder where Hypothesis keeps the examples that failed, to begin with next time."""
    known: set[Bug] = field(default_factory=set)
    rounds: int = 0
    """That are over."""
    tried: int = 0
    """Cases."""
    told: Callable[[Hunt], None] = lambda hunt: None
    """Called after every case."""
    shrinking: float = SHRINKING
    """Seconds for making one failure smaller, at the most."""
    clock: Callable[[], float] = time.monotonic
    """Seconds; of the processor alone where others have it too: `time.process_time`."""
    started: float = 0.0
    """By the clock."""

    def run(self, seconds: float) -> Iterable[Found]:
        """Until the time is up, each bug when it has been made small, which may take `shrinking` longer."""
        self.started = self.clock()
        until = self.started + seconds
        while self.clock() < until:
            method = self.methods[self.rounds % len(self.methods)]
            found = _Round(self, method, until).run()
            self.rounds += 1
            if found is not None:
                self.known.add(found.bug)
                yield found


@dataclass(frozen=True)
class _Shown:
    """A bug on a case."""

    case: Case
    failure: Failure


class _Examples(DirectoryBasedExampleDatabase):
    """Keeps an example as long as it shows a bug: one that is known by now is no failure in Hypothesis' eyes."""

    def __init__(self, place: Path) -> None:
        super().__init__(place)
        self.last_is_wrong = False

    def delete(self, key: bytes, value: bytes) -> None:
        """What Hypothesis does with an example just after it was tried, and found right."""
        if not self.last_is_wrong:
            super().delete(key, value)


class _Round:
    """One run of Hypothesis, which looks for one bug."""

    def __init__(self, hunt: Hunt, method: str, until: float) -> None:
        self.hunt, self.method, self.until = hunt, method, until
        self.number = hunt.seed + hunt.rounds
        self.before, self.seconds = hunt.tried, 0.0
        self.examples = None if hunt.database is None else _Examples(hunt.database / method)
        self.bug: Bug | None = None
        self.smallest: _Shown | None = None

    def run(self) -> Found | None:
        """The bug that it found, if any."""
        started = self.hunt.tried
        with suppress(WrongError, _TimeIsUp, HypothesisException):  # one that does not come again is a failure too
            self._test()()
        if self.bug is None or self.smallest is None:
            return None
        bug = with_causes(self.smallest.case, self.smallest.failure)
        return Found(bug, self.smallest.case, self.before - started, self.seconds, self.number)

    def _test(self) -> Callable[[], None]:
        chosen = settings(
            max_examples=ROUND,
            deadline=None,
            database=self.examples,
            phases=[Phase.reuse, Phase.generate, Phase.shrink],
            suppress_health_check=list(HealthCheck),
            report_multiple_bugs=False,
        )
        drawn = given(cases(self.method, self.hunt.system))
        return chosen(seed(self.number)(drawn(self._try)))  # seed alone would drop the database

    def _try(self, case: Case) -> None:
        if self.hunt.clock() > self.until and self.hunt.tried:  # the first case may have to wait for kernels
            raise _TimeIsUp
        failure, wrong = shown(case, self.hunt.port, self.hunt.device, self.hunt.known)
        if self.examples is not None:
            self.examples.last_is_wrong = wrong
        self.hunt.tried += 1
        self.hunt.told(self.hunt)
        if failure is None or failure.bug != (self.bug or failure.bug):
            return
        bug = failure.bug
        if self.bug is None:
            now = self.hunt.clock()
            self.bug, self.before, self.seconds = bug, self.hunt.tried, now - self.hunt.started
            self.until = now + self.hunt.shrinking
        if self.smallest is None or size_of(case) <= size_of(self.smallest.case):
            self.smallest = _Shown(case, failure)
        raise WrongError(bug.name)


def size_of(case: Case) -> tuple[int, int]:
    """What is small: pixels, then numbers in the arrays of the scene and its parameters."""
    camera = case.scene.camera
    return camera.width * camera.height, _numbers((case.scene, case.params))


def _numbers(part: object) -> int:
    """Numbers in a description, and steps and samples as many as they say."""
    if isinstance(part, np.ndarray):
        return part.size
    if isinstance(part, (tuple, list)):
        return sum(map(_numbers, part))
    if isinstance(part, int):
        return abs(int(part))
    return sum(map(_numbers, vars(part).values())) if hasattr(part, "__dataclass_fields__") else 1
