"""The built-in cases: at least four a method, easy, typical, adversarial and real-sized."""

from __future__ import annotations

from collections.abc import Callable

from ibr_ref.oracle.cases.case import Case
from ibr_ref.scene import checks

__all__ = ["CASES", "Case", "build", "names"]

CASES: dict[str, Callable[[], Case]] = {}
"""What makes each case, by its name."""


def names() -> list[str]:
    """Of all built-in cases, method by method."""
    return list(CASES)


def build(name: str) -> Case:
    """The built-in case of that name. Raises ValueError for an unknown one."""
    checks.choice("case", name, names())
    return CASES[name]()
