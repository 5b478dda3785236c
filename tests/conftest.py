"""Fixtures for tests of every method."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numba
import pytest

LONGEST = ("tests/test_notebooks.py", "tests/test_determinism.py", "tests/test_memory.py")


@pytest.hookimpl(tryfirst=True)  # before pytest chooses by marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Of what is `sampled` all but every n-th, the middle of each n, is `long`; and the longest first.

    One that begins when the others are done leaves all cores but its own idle.
    """
    seen: Counter[str] = Counter()
    for item in items:
        sampled, name = item.get_closest_marker("sampled"), item.nodeid.partition("[")[0]
        if sampled is not None and seen[name] % sampled.args[0] != sampled.args[0] // 2:
            item.add_marker("long")
        seen[name] += 1
    items.sort(key=lambda item: not item.nodeid.startswith(LONGEST))


@pytest.fixture
def one_thread() -> Iterator[None]:
    """Pictures of a few hundred pixels are slower on several threads, much slower where others want the cores too."""
    before = numba.get_num_threads()
    numba.set_num_threads(1)
    yield
    numba.set_num_threads(before)
