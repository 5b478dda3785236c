from __future__ import annotations

import pytest

from tests.oracle.plain_referee import PlainReferee


@pytest.fixture
def plain_referee(monkeypatch: pytest.MonkeyPatch) -> PlainReferee:
    """The engine judges by plain comparison."""
    judge = PlainReferee()
    for module in ("examination", "trials", "conventions", "bias"):
        monkeypatch.setattr(f"ibr_ref.oracle.{module}.referee", lambda method: judge)
    return judge
