"""Fixtures for tests of every method."""

from __future__ import annotations

from collections.abc import Iterator

import numba
import pytest

LONGEST = ("tests/test_notebooks.py", "tests/test_determinism.py", "tests/test_memory.py")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest first: one that begins when the others are done leaves all cores but its own idle."""
    items.sort(key=lambda item: not item.nodeid.startswith(LONGEST))


@pytest.fixture
def one_thread() -> Iterator[None]:
    """Pictures of a few hundred pixels are slower on several threads, much slower where others want the cores too."""
    before = numba.get_num_threads()
    numba.set_num_threads(1)
    yield
    numba.set_num_threads(before)
