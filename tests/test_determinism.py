"""The same bits for any number of threads, for any processor, and however the kernels are compiled.

Each way is a process of its own, as Numba reads its switches once. They share the disk cache with everything else;
with an empty one every process but one compiles all kernels, so that two run at a time.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests import golden

ROOT = Path(golden.__file__).parents[1]
SMALL, TINY = "48x36", "16x12"


@dataclass(frozen=True)
class Way:
    """Switches, what they must have led to, and what is rendered."""

    switches: dict[str, str]
    circumstances: dict[str, Any]
    size: str = SMALL
    scenes: tuple[str, ...] = ()
    """Empty: all."""


pytestmark = pytest.mark.long

WAYS = {
    "two threads": Way({"NUMBA_NUM_THREADS": "2"}, {"threads": 2, "serial": False, "compiled": True}),
    "bounds checked, for a generic processor": Way(
        {"IBR_REF_SERIAL": "1", "NUMBA_BOUNDSCHECK": "1", "NUMBA_CPU_NAME": "generic"},
        {"serial": True, "bounds checked": True, "processor": "generic"},
    ),
    "one thread": Way({"NUMBA_NUM_THREADS": "1"}, {"threads": 1, "serial": False}),
    "tiny": Way({}, {"compiled": True}, TINY, golden.TINY),
    "not compiled": Way({"NUMBA_DISABLE_JIT": "1"}, {"compiled": False}, TINY, golden.TINY),
}
"""In the order of their starts: those with one thread and two share compiled kernels, and so are apart.

Whoever compiles for another processor compiles everything anew, and so does whoever checks bounds: both at once are one
compilation, and the bits of either way would differ.
"""


def run(way: Way) -> dict[str, Any]:
    """Render in a process of its own: circumstances and digests."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("NUMBA_", "IBR_REF_"))}
    if "NUMBA_CACHE_DIR" in os.environ:
        kept["NUMBA_CACHE_DIR"] = os.environ["NUMBA_CACHE_DIR"]
    command = [sys.executable, "-m", "tests.golden", "--size", way.size, *way.scenes]
    done = subprocess.run(command, cwd=ROOT, env=kept | way.switches, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{way.switches}: {done.stderr[-4000:]}"
    return json.loads(done.stdout)  # type: ignore[no-any-return]


@pytest.fixture(scope="module")
def results() -> Iterator[dict[str, Future[dict[str, Any]]]]:
    """All ways, started together, two at a time."""
    with ThreadPoolExecutor(2) as pool:
        futures = {name: pool.submit(run, way) for name, way in WAYS.items()}
        yield futures
        pool.shutdown(cancel_futures=True)


def differing(digests: dict[str, golden.Digests], expected: dict[str, golden.Digests]) -> dict[str, list[str]]:
    """The arrays that differ, by the name of the scene, in those scenes that were rendered."""
    assert digests.keys() <= expected.keys()
    changed = {name: golden.changed(digests[name], expected[name]) for name in digests}
    return {name: arrays for name, arrays in changed.items() if arrays}


@pytest.mark.parametrize("name", WAYS)
def test_switches_take_effect(name: str, results: dict[str, Future[dict[str, Any]]]) -> None:
    circumstances = results[name].result()["circumstances"]
    assert WAYS[name].circumstances.items() <= circumstances.items()


@pytest.mark.parametrize("name", ["one thread", "bounds checked, for a generic processor"])
def test_bits_are_those_of_two_threads(name: str, results: dict[str, Future[dict[str, Any]]]) -> None:
    assert not differing(results[name].result()["digests"], results["two threads"].result()["digests"])


def test_every_scene_is_rendered_with_bounds_checked(results: dict[str, Future[dict[str, Any]]]) -> None:
    assert list(results["bounds checked, for a generic processor"].result()["digests"]) == list(golden.SCENES)


def test_bits_are_those_of_plain_python(results: dict[str, Future[dict[str, Any]]]) -> None:
    assert not differing(results["tiny"].result()["digests"], results["not compiled"].result()["digests"])
