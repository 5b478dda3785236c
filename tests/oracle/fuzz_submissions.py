"""Submissions with whole arrays replaced: an answer each time, never a traceback or a warning, never PASS where it shows.

    python -m tests.oracle.fuzz_submissions --count 100000 --workers 2

Each input follows from the seed and its number alone: `--first N` goes on where a run has stopped, and `--first N --count 1`
shows one again. The figures are printed at the end, the inputs that failed as they are found.
"""

from __future__ import annotations

import argparse
import multiprocessing
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numba
import numpy as np

from ibr_ref import oracle
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.findings import Outcome
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.report import page
from ibr_ref.oracle.trials import judge
from ibr_ref.oracle.verdict import Verdict
from tests.oracle.tiny_cases import TINY, handed_of

Array = np.ndarray
Random = np.random.Generator

BLOCK = 50
"""Inputs in a row of one case and profile: referees keep what follows from these."""
TOLD = 20
"""Of so many inputs one is also told: witnesses, what the device would need, words, JSON; of ten of these a page and causes.
The others are judged, which is a fifth of the time."""
SHOWS = 0.05
"""An element that moves by more, of numbers about 1, is seen in any array of any case."""


def _filled(value: float) -> Callable[[Array, Random], Array]:
    return lambda a, random: np.full_like(a, value)


FLOATS: dict[str, Callable[[Array, Random], Array]] = {
    "zeros": _filled(0.0),
    "ones": _filled(1.0),
    "minus ones": _filled(-1.0),
    "NaN": _filled(np.nan),
    "infinity": _filled(np.inf),
    "minus infinity": _filled(-np.inf),
    "1e30": _filled(1e30),
    "-1e30": _filled(-1e30),
    "largest float32": _filled(3.4028235e38),
    "denormal": _filled(1e-42),
    "constant": lambda a, random: np.full_like(a, random.uniform(-2.0, 2.0)),
    "scaled by 1e-4": lambda a, random: a * 1e-4,
    "scaled by 1e4": lambda a, random: a * 1e4,
    "negated": lambda a, random: -a,
    "noise": lambda a, random: random.standard_normal(a.shape),
    "moved": lambda a, random: a + random.choice([-5.0, -0.5, 0.5, 5.0]),
    "one NaN": lambda a, random: np.where(np.arange(a.size).reshape(a.shape) == random.integers(a.size), np.nan, a),
    "some infinite": lambda a, random: np.where(random.random(a.shape) < 0.2, np.inf, a),
}
WHOLES: dict[str, Callable[[Array, Random], Array]] = {
    "zeros": _filled(0),
    "ones": _filled(1),
    "minus ones": lambda a, random: np.full_like(a, -1 if a.dtype.kind == "i" else 1),
    "least": lambda a, random: np.full_like(a, np.iinfo(a.dtype).min),
    "largest": lambda a, random: np.full_like(a, np.iinfo(a.dtype).max),
    "constant": lambda a, random: np.full_like(a, random.integers(0, 100)),
    "random": lambda a, random: random.integers(np.iinfo(a.dtype).min, np.iinfo(a.dtype).max, a.shape).astype(a.dtype),
    "small": lambda a, random: random.integers(0, 8, a.shape).astype(a.dtype),
}
FLAGS: dict[str, Callable[[Array, Random], Array]] = {
    "none": _filled(False),
    "all": _filled(True),
    "turned": lambda a, random: ~a,
}
ANY: dict[str, Callable[[Array, Random], Array]] = {
    "reversed": lambda a, random: np.ascontiguousarray(a[::-1]),
    "mirrored": lambda a, random: np.ascontiguousarray(a[..., ::-1]),
    "rolled": lambda a, random: np.roll(a, 1, axis=int(random.integers(a.ndim))),
    "shuffled": lambda a, random: random.permutation(a.reshape(-1)).reshape(a.shape),
    "repeated": lambda a, random: np.broadcast_to(a[:1], a.shape).copy(),
}
FACES: dict[str, Callable[[Array, Random], Array]] = {
    "a face less": lambda a, random: a[4:].copy(),
    "a face more": lambda a, random: np.concatenate([a, a[-4:]]),
    "no face": lambda a, random: a[:0].copy(),
}
"""Of the corners of faces, which may be too many or too few."""


def replacements(name: str, array: Array) -> dict[str, Callable[[Array, Random], Array]]:
    """What an array may be replaced by."""
    kinds = {"f": FLOATS, "b": FLAGS}.get(array.dtype.kind, WHOLES)
    faces = FACES if name in ("vertex.clip", "vertex.patch") else {}
    return {**kinds, **ANY, **faces}


@dataclass(frozen=True)
class Input:
    """One submission."""

    number: int
    case: str
    changes: dict[str, str]
    """By array what it is replaced by."""
    handed: dict[str, Any]
    profile: str
    apart: dict[str, Array]
    """Of replaced arrays where they differ from the reference's by what no device explains; of all there is, where the size
    is another."""

    @property
    def shows(self) -> bool:
        """Whether any of them does."""
        return any(where.any() for where in self.apart.values())


@cache
def _reference(name: str) -> tuple[oracle.Case, dict[str, Any]]:
    case = TINY[name]()
    return case, handed_of(case)


def made(number: int, seed: int) -> Input:
    """An input by its number."""
    random = np.random.default_rng([seed, number])
    block = number // BLOCK
    name, profile = [*TINY][block % len(TINY)], [*PROFILES][block // len(TINY) % len(PROFILES)]
    _, reference = _reference(name)
    names = [*reference]
    if random.random() < 0.5:  # some of the arrays
        kept = random.random(len(names)) < random.uniform(0.1, 0.9)
        names = [n for n, there in zip(names, kept, strict=True) if there] or names
    handed = {n: reference[n] for n in names}
    if "color" in handed and random.random() < 0.7:  # judged in a fifth of the time
        del handed["color"]
        handed = handed or dict(reference)
    changed = random.choice([*handed], size=min(len(handed), int(random.choice([1, 1, 1, 2, 3]))), replace=False)
    changes, apart = {}, {}
    for array in map(str, changed):
        pages = handed[array] if isinstance(handed[array], tuple) else (handed[array],)
        options = replacements(array, pages[0])
        changes[array] = str(random.choice([*options]))
        new = tuple(options[changes[array]](page, random) for page in pages)
        found = [differs(a, b) for a, b in zip(pages, new, strict=True)]
        apart[array] = found[0] if len(found) == 1 else np.array([where.any() for where in found])
        handed[array] = new if isinstance(handed[array], tuple) else new[0]
    return Input(number, name, changes, handed, profile, apart)


def differs(ours: Array, theirs: Array) -> Array:
    """Where numbers differ by what shows."""
    if ours.shape != theirs.shape:
        return np.ones(1, np.bool_)
    if ours.dtype.kind != "f":
        return ours != theirs
    with np.errstate(all="ignore"):
        apart = np.abs(ours - theirs) > SHOWS * np.maximum(np.abs(ours), 1.0)
    return apart | (np.isfinite(ours) != np.isfinite(theirs))


def decided(one: Input, judgements: list[Judgement]) -> bool:
    """Whether what shows does so somewhere where a verdict can be had: elsewhere a device may compute anything."""
    open_ = {name: judgement.undecided for judgement in judgements for name in judgement.arrays}
    for name, where in one.apart.items():
        undecided = open_.get(name)
        if undecided is None or where.shape[: undecided.ndim] != undecided.shape:
            if where.any():
                return True
        elif (where.reshape(*undecided.shape, -1).any(axis=-1) & ~undecided).any():
            return True
    return False


def judged(one: Input, *, tell: bool) -> tuple[Outcome, bool]:
    """What the judgements come to, with warnings as errors, and whether what shows is decided. tell: in all its forms."""
    case, _ = _reference(one.case)
    picture = {name: one.handed[name] for name in ("color", "depth") if name in one.handed}
    stages = {name: array for name, array in one.handed.items() if name not in picture}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        submission = oracle.submission_from_arrays(case, stages=stages, **picture)
        if submission.problems:
            return told(one, submission), one.shows
        with np.errstate(all="ignore"):  # as `examine` does
            judgements = judge(case, submission.handed, PROFILES[one.profile])
        outcome = Outcome.FAIL if any(j.wrong.any() for j in judgements) else Outcome.PASS
        return (told(one, submission) if tell else outcome), decided(one, judgements)


def told(one: Input, submission: oracle.Submission) -> Outcome:
    """Checked, and told in all its forms."""
    case, _ = _reference(one.case)
    examination = oracle.check(case, submission, profile=one.profile, name_causes=one.number % (10 * TOLD) == 0)
    verdict = examination.verdict
    assert verdict.words().startswith(str(verdict.outcome))
    assert Verdict.model_validate_json(verdict.model_dump_json()) == verdict
    assert not any(not witness.trace for witness in verdict.witnesses), f"no trace:\n{verdict.words()}"
    if one.number % (10 * TOLD) == 0:
        assert page(examination)
    return verdict.outcome


def complaint(one: Input, *, tell: bool = True) -> tuple[str, str | None]:
    """The outcome, and what is wrong with it."""
    try:
        outcome, shows = judged(one, tell=tell)
    except Exception:  # what is looked for
        return "traceback", traceback.format_exc(limit=-4)
    if outcome is Outcome.PASS and shows:
        return "PASS where it shows", f"PASS by {one.profile}"
    return str(outcome), None


def _tried(task: tuple[int, int]) -> tuple[str, str, str | None]:
    one = made(*task)
    outcome, words = complaint(one, tell=one.number % TOLD == 0)
    where = f"input {one.number}: {one.case}, {one.changes} of {[*one.handed]}, {one.profile}"
    return one.case, outcome, None if words is None else f"{where}\n{words}"


def alone() -> None:
    """One thread: pictures of a few hundred pixels cost more to share out than to draw."""
    numba.set_num_threads(1)


def run(numbers: range, seed: int, workers: int) -> Iterator[tuple[str, str, str | None]]:
    """The case, the outcome, and the complaint of each input."""
    tasks = ((number, seed) for number in numbers)
    if workers <= 1:
        yield from map(_tried, tasks)
        return
    with multiprocessing.get_context("spawn").Pool(workers, alone) as pool:
        yield from pool.imap(_tried, tasks, chunksize=BLOCK)


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.oracle.fuzz_submissions", description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first input: go on where a run has stopped")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args()
    alone()
    started, found, complaints = time.time(), Counter[tuple[str, str]](), 0
    for i, (case, outcome, words) in enumerate(
        run(range(options.first, options.first + options.count), options.seed, options.workers), 1
    ):
        found[case.partition("-")[0], outcome] += 1
        if words is not None:
            complaints += 1
            print(words, flush=True)
        if i % 500 == 0:
            print(f"{i:,} inputs, next --first {options.first + i}, {complaints} complaints", flush=True)
    for (method, outcome), count in sorted(found.items()):
        print(f"{method:14}{outcome:22}{count:8,}")
    taken = time.time() - started
    print(f"{options.count:,} inputs, seed {options.seed}, {complaints} complaints, {taken:.0f} s")
    return int(complaints > 0)


if __name__ == "__main__":
    raise SystemExit(main())
