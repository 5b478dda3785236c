"""The built-in cases: at least four a method, easy, typical, adversarial and real-sized."""

from __future__ import annotations

import re
from fnmatch import fnmatchcase

from ibr_ref.methods import named, records
from ibr_ref.oracle.cases.case import Case
from ibr_ref.scene import checks

__all__ = ["Case", "build", "matching", "names"]


def names(method: str | None = None) -> list[str]:
    """Of all cases, or of one method's, in the order in which a port author would try them."""
    methods = records() if method is None else (named(method),)
    return [name for m in methods for name in m.cases.open()]


def matching(pattern: str) -> list[str]:
    """Those whose names have a pattern; the cases of a method whose names cannot have it are not even imported."""
    start = re.split(r"[*?\[]", pattern, maxsplit=1)[0]
    heads = [(m.name, f"{m.name}-") for m in records()]
    methods = [name for name, head in heads if head.startswith(start) or start.startswith(head)]
    return [name for method in methods for name in names(method) if fnmatchcase(name, pattern)]


def build(name: str) -> Case:
    """The case of that name. Raises ValueError with all names for another."""
    for method in records():
        made = method.cases.open() if name.startswith(f"{method.name}-") else {}
        if name in made:
            case: Case = made[name]()
            return case
    raise checks.reject("case", name, " | ".join(names()))
