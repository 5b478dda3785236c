from __future__ import annotations

import pytest

from tests.oracle.plain_referee import PlainReferee, judges_all


@pytest.fixture
def plain_referee(monkeypatch: pytest.MonkeyPatch) -> PlainReferee:
    """The engine judges by plain comparison."""
    return judges_all(monkeypatch)
