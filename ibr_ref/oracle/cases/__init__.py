"""The built-in cases: at least four a method, easy, typical, adversarial and real-sized."""

from __future__ import annotations

from ibr_ref.methods import named, records
from ibr_ref.oracle.cases.case import Case
from ibr_ref.scene import checks

__all__ = ["Case", "build", "names"]


def names(method: str | None = None) -> list[str]:
    """Of all cases, or of one method's, in the order in which a port author would try them."""
    methods = records() if method is None else (named(method),)
    return [name for m in methods for name in m.cases.open()]


def build(name: str) -> Case:
    """The case of that name. Raises ValueError with all names for another."""
    for method in records():
        made = method.cases.open() if name.startswith(f"{method.name}-") else {}
        if name in made:
            case: Case = made[name]()
            return case
    raise checks.reject("case", name, " | ".join(names()))
