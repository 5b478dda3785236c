"""The built-in cases: at least four a method, easy, typical, adversarial and real-sized."""

from __future__ import annotations

from importlib import import_module

from ibr_ref.oracle.cases.case import Case
from ibr_ref.scene import checks

METHODS = ("displacement", "splatting", "shadows")

__all__ = ["METHODS", "Case", "build", "names"]


def names(method: str | None = None) -> list[str]:
    """Of all cases, or of one method's, in the order in which a port author would try them."""
    methods = METHODS if method is None else (method,)
    return [name for m in methods for name in import_module(f"ibr_ref.oracle.cases.{m}").CASES]


def build(name: str) -> Case:
    """The case of that name. Raises ValueError with all names for another."""
    method = name.partition("-")[0]
    if method not in METHODS or name not in names(method):
        raise checks.reject("case", name, " | ".join(names()))
    case: Case = import_module(f"ibr_ref.oracle.cases.{method}").CASES[name]()
    return case
