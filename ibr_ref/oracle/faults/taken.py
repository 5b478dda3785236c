"""Parameters as suspects: the right program with a number in place of the case's, as a port may have left it or set it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from ibr_ref.oracle.faults.kinds import Mutant, PlainPort


def suspects(port: type[PlainPort], params: Any, stages: Mapping[str, str]) -> list[Mutant]:
    """One for each other number of the fields of `params`; stages: by field, the first stage that reads it."""
    return [
        Mutant(
            name=f"{name} = {other}",
            fault=f"The port is right with {name} = {other}; the case has {getattr(params, name)}.",
            stage=stage,
            port=type("Taken", (port,), {"taken": {name: other}, "__module__": __name__}),
        )
        for name, stage in stages.items()
        for other in others(params, name)
    ]


def others(params: Any, name: str) -> list[int | float]:
    """Numbers that ports have by mistake, those that the parameters allow: the default, one more or less, double, half."""
    value = getattr(params, name)
    near = (value + 1, value - 1, 2 * value, value // 2) if isinstance(value, int) else (2.0 * value, 0.5 * value)
    default = next(field.default for field in fields(params) if field.name == name)
    return [x for x in dict.fromkeys((default, *near)) if x != value and _allowed(params, name, x)]


def _allowed(params: Any, name: str, value: float) -> bool:
    try:
        replace(params, **{name: value})
    except ValueError:
        return False
    return True
