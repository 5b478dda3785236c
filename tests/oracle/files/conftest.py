"""The small cases, each made, rendered and exported once."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.files import export
from tests.oracle.files.cases import CASES, FULL


@cache
def _made(name: str) -> Case:
    return CASES[name]()


@pytest.fixture(params=CASES)
def case(request: pytest.FixtureRequest) -> Case:
    """Each of the cases."""
    return _made(request.param)


@pytest.fixture(params=FULL)
def full_case(request: pytest.FixtureRequest) -> Case:
    """One case a method."""
    return _made(request.param)


@pytest.fixture
def maps_case() -> Case:
    """The case of displacement."""
    return _made("maps")


@pytest.fixture
def folder(full_case: Case, tmp_path: Path) -> Path:
    """An export of `full_case` that a test may spoil."""
    export(full_case, tmp_path / "case")
    return tmp_path / "case"
