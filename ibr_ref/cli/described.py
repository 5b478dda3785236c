"""Options that `render` and `view` share: those of what is drawn, which the method reads."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import Any, NamedTuple, TypeVar

Made = TypeVar("Made")


class Described(NamedTuple):
    """What options describe."""

    scene: Any
    """The method's Scene."""
    params: Any
    """The method's Params."""
    inputs: dict[str, Any]
    """What else `render` is given."""
    photograph: Callable[[], Any] = lambda: None
    """Reads what a camera saw from there, a DepthImage, if there is such a thing."""


def beside(read: Callable[..., Any]) -> Callable[[Callable[..., Made]], Callable[..., Made]]:
    """A decorator for a command that hands on to `read` whatever options it has not itself: it gets both, its own first.

    What `read` takes by keyword alone is no option.
    """

    def decorate(command: Callable[..., Made]) -> Callable[..., Made]:
        @wraps(command)
        def both(*arguments: Any, **options: Any) -> Made:
            return command(*arguments, **options)

        parameters = [*_own(command), *_own(read)]
        required = [p for p in parameters if p.default is Parameter.empty]
        optional = [p for p in parameters if p.default is not Parameter.empty]
        both.__signature__ = Signature(required + optional)  # type: ignore[attr-defined]
        both.__annotations__ = {p.name: p.annotation for p in required + optional}
        return both

    return decorate


def _own(function: Callable[..., Any]) -> list[Parameter]:
    """Parameters with a name, and their annotations as what they say."""
    found = signature(function, eval_str=True).parameters.values()
    return [parameter for parameter in found if parameter.kind is Parameter.POSITIONAL_OR_KEYWORD]
