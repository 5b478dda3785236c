"""Commands that refuse what nothing would read.

An option that was given, be it with its default value, and that does not go with the others is refused by name, with the
reason: `what_goes_with_what` is the table.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from enum import Enum
from typing import Any

import typer
from typer.core import TyperCommand

from ibr_ref.cli.what_goes_with_what import ABSENT, GIVEN, Beside, Others, rules

_NOTHING: tuple[Any, ...] = (None, False, (), [])
"""Values of parameters that are not there."""


class Command(TyperCommand):
    """A command that refuses what nothing would read, before it does anything; its help shows defaults as they are typed."""

    def __init__(self, *args: Any, **named: Any) -> None:
        super().__init__(*args, **named)
        for param in self.params:
            if isinstance(param.default, tuple):
                param.show_default = str(param.default)  # type: ignore[attr-defined]

    def invoke(self, ctx: Any) -> Any:
        """Check what was given, then run."""
        refuse(rules(path(ctx)), self.params, ctx.params, given(ctx))
        return super().invoke(ctx)


def path(ctx: Any) -> str:
    """The command's name below the program's, such as "render shadows"."""
    names = []
    while ctx.parent is not None:
        names.append(ctx.info_name)
        ctx = ctx.parent
    return " ".join(reversed(names))


def given(ctx: Any) -> set[str]:
    """Names of the parameters that stand on the command line."""
    return {name for name in ctx.params if getattr(ctx.get_parameter_source(name), "name", "") == "COMMANDLINE"}


def refuse(wanted: Mapping[str, Beside], params: list[Any], values: Mapping[str, Any], names: set[str]) -> None:
    """Raise BadParameter for the first given parameter that is not read beside the values of the others."""
    flags = {param.name: _flag(param) for param in params}
    for param in params:
        rule = wanted[param.name]
        if param.name not in names or not rule.alternatives:
            continue
        misses = [list(_missed(alternative, values)) for alternative in rule.alternatives]
        if not all(misses):
            continue
        fewest = min(misses, key=len)
        found = " and ".join(_said(flags[name], values[name]) for name in fewest)
        allowed = ", or ".join(_allowed(flags, alternative) for alternative in rule.alternatives)
        value = values[param.name]
        shown = "" if isinstance(value, bool) else f"{_shown(value)} "
        raise typer.BadParameter(f"{flags[param.name]}: found {shown}{found}, allowed: {allowed} ({rule.why})")


def _missed(alternative: Others, values: Mapping[str, Any]) -> Iterator[str]:
    """The parameters that are not as the alternative has them."""
    for name, wanted in alternative.items():
        there = values[name] not in _NOTHING
        value = values[name].value if isinstance(values[name], Enum) else values[name]
        if wanted is GIVEN or wanted is ABSENT:
            if there != (wanted is GIVEN):
                yield name
        elif value not in (wanted if isinstance(wanted, tuple) else (wanted,)):
            yield name


def _flag(param: Any) -> str:
    """As it is written: --no-such-thing, or CASE."""
    if param.param_type_name == "argument":
        return str(param.metavar or param.name).upper()
    return str(max(param.opts, key=len))


def _shown(value: Any) -> str:
    value = value.value if isinstance(value, Enum) else value
    text = " ".join(map(str, value)) if type(value) in (list, tuple) else str(value)
    return text if len(text) <= 80 else text[:77] + "..."


def _said(flag: str, value: Any) -> str:
    """A parameter and its value as they are, or that it is not there."""
    if value in _NOTHING:
        return f"without {flag}"
    return f"beside {flag}" if value is True else f"beside {flag} {_shown(value)}"


def _allowed(flags: Mapping[str, str], alternative: Others) -> str:
    """What an alternative wants."""
    words = []
    for name, wanted in alternative.items():
        if wanted is ABSENT:
            words.append(f"without {flags[name]}")
        elif wanted is GIVEN:
            words.append(f"beside {flags[name]}")
        else:
            values = wanted if isinstance(wanted, tuple) else (wanted,)
            words.append(f"beside {flags[name]} {' | '.join(map(str, values))}")
    return " and ".join(words)
