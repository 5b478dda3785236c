"""Right ports on random devices, every fourth with 4 subpixel bits, on random small cases: none may be accused.

    python -m tests.oracle.fuzz_devices --count 2000 --workers 2

A block of cases follows from the seed and its number alone: `--first N` goes on where a run has stopped, and
`--first N --count 20` shows one again. Devices that were accused are printed as they are found, the figures at the end.
"""

from __future__ import annotations

import argparse
import multiprocessing
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings

from ibr_ref import methods, oracle
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.findings import Outcome
from ibr_ref.testing import cases
from tests.oracle.devices import random_policy
from tests.oracle.fuzz_submissions import alone

BLOCK = 20
"""Cases in a row of one system."""
SYSTEMS = [(name, system) for name in methods.names() for system in (None, *methods.named(name).judged[1])]


@dataclass(frozen=True)
class Tried:
    """A device on a case."""

    system: str
    profile: str
    undecided: int
    """Of the pixels of the last stage that was judged."""
    pixels: int
    complaint: str | None


def tried(number: int, of: int) -> list[Tried]:
    """The devices of a block."""
    method, system = SYSTEMS[number % len(SYSTEMS)]
    random, found = np.random.default_rng([of, number]), list[Tried]()

    def judge(case: Case) -> None:
        found.append(judged(case, random, f"block {number}, case {len(found)}"))

    chosen = settings(
        database=None, deadline=None, max_examples=BLOCK, phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    chosen(seed(1000 * of + number)(given(cases(method, system))(judge)))()
    return found


def judged(case: Case, random: np.random.Generator, where: str) -> Tried:
    """The right port by one device, by all it has or by some of its arrays."""
    policy, profile = random_policy(random)
    if random.integers(4) == 0:
        policy, profile = replace(policy, subpixel_bits=4), f"{profile},subpixel_bits=4"
    port = methods.named(case.method).plain_port
    assert port is not None
    arrays = port.open().Port(case.scene, case.params, policy, case.inputs).render()
    if random.integers(2):
        kept = random.random(len(arrays)) < random.uniform(0.2, 0.9)
        some = {name: array for (name, array), there in zip(arrays.items(), kept, strict=True) if there}
        arrays = some if {*some} - {"depth"} else arrays  # which alone says nothing
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        picture = {name: arrays[name] for name in ("color", "depth") if name in arrays}
        stages = {name: array for name, array in arrays.items() if name not in picture}
        submission = oracle.submission_from_arrays(case, stages=stages, **picture)
        examination = oracle.check(case, submission, profile=profile, name_causes=False)
    verdict = examination.verdict
    last = examination.judgements[-1].undecided if examination.judgements else np.zeros(0, np.bool_)
    complaint = None
    if verdict.outcome is not Outcome.PASS:
        complaint = f"{where}: {case.name} {case.params}\n{policy} by {profile}, {[*arrays]}\n{verdict.words()}"
    return Tried(f"{case.method} {case.system}", profile, int(last.sum()), last.size, complaint)


def run(blocks: range, of: int, workers: int) -> Iterator[Tried]:
    """All devices of some blocks."""
    tasks = [(number, of) for number in blocks]
    if workers <= 1:
        for task in tasks:
            yield from tried(*task)
        return
    with multiprocessing.get_context("spawn").Pool(workers, alone) as pool:
        for found in pool.imap(_tried, tasks):
            yield from found


def _tried(task: tuple[int, int]) -> list[Tried]:
    return tried(*task)


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.oracle.fuzz_devices", description=__doc__)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--first", type=int, default=0, help="number of the first case: go on where a run has stopped")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args()
    alone()
    blocks = range(options.first // BLOCK, -(-(options.first + options.count) // BLOCK))
    started, devices, accused = time.time(), Counter[str](), Counter[str]()
    undecided, pixels = Counter[str](), Counter[str]()
    for i, one in enumerate(run(blocks, options.seed, options.workers), 1):
        devices[one.system] += 1
        undecided[one.system] += one.undecided
        pixels[one.system] += one.pixels
        if one.complaint is not None:
            accused[one.system] += 1
            print(one.complaint, flush=True)
        if i % 200 == 0:
            print(f"{i:,} devices, {accused.total()} accused, {time.time() - started:.0f} s", flush=True)
    for system, count in sorted(devices.items()):
        open_ = undecided[system] / max(pixels[system], 1)
        print(f"{system:28}{count:8,} devices {accused[system]:6,} accused, undecided {open_:.1%}")
    print(f"{devices.total():,} devices, seed {options.seed}, {accused.total()} accused, {time.time() - started:.0f} s")
    return int(accused.total() > 0)


if __name__ == "__main__":
    raise SystemExit(main())
