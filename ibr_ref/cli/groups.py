"""Options in groups: what belongs together is a dataclass, whose fields are options; Typer sees these one by one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import Any, TypeVar, get_type_hints

Made = TypeVar("Made")


def grouped(function: Callable[..., Made]) -> Callable[..., Made]:
    """A decorator for a function that takes groups: it is called with their fields, by name, in place of them.

    A group is a dataclass, fields of which may be groups too. In the signature they stand where the group stands, those
    that must be given first.
    """
    parameters = signature(function, eval_str=True).parameters.values()
    groups = {p.name: p.annotation for p in parameters if is_dataclass(p.annotation)}

    @wraps(function)
    def one_by_one(*arguments: Any, **given: Any) -> Made:
        made = {name: _made(group, given) for name, group in groups.items()}
        return function(*arguments, **made, **given)

    apart = [each for parameter in parameters for each in _taken_apart(parameter)]
    return signed(one_by_one, apart)


def signed(function: Callable[..., Made], parameters: list[Parameter]) -> Callable[..., Made]:
    """A function that says that it has these parameters, of the same kind those without a default first."""
    ordered = sorted(parameters, key=lambda p: (p.kind, p.default is not Parameter.empty))
    function.__signature__ = Signature(ordered)  # type: ignore[attr-defined]
    function.__annotations__ = {p.name: p.annotation for p in ordered}
    return function


def _taken_apart(parameter: Parameter) -> Iterator[Parameter]:
    """The parameter, or the fields of the group that it is."""
    group = parameter.annotation
    if not is_dataclass(group):
        yield parameter
        return
    hints = get_type_hints(group, include_extras=True)
    for field in fields(group):
        default = Parameter.empty if field.default is MISSING else field.default
        yield from _taken_apart(Parameter(field.name, parameter.kind, default=default, annotation=hints[field.name]))


def _made(group: Any, given: dict[str, Any]) -> Any:
    """A group of what is given, which is taken out of there."""
    hints = get_type_hints(group)
    found = {name: _made(hint, given) for name, hint in hints.items() if is_dataclass(hint)}
    named = [field.name for field in fields(group) if field.name not in found and field.name in given]
    return group(**found, **{name: given.pop(name) for name in named})


def told(group: Any, *but: str) -> dict[str, Any]:
    """The options of a group by name, words as plain strings; but for some."""
    values = {field.name: getattr(group, field.name) for field in fields(group) if field.name not in but}
    return {name: value.value if isinstance(value, Enum) else value for name, value in values.items()}
