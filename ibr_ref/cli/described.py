"""Options that `render` and `view` share: those of what is drawn, which the method reads."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, signature
from typing import Any, NamedTuple, TypeVar

from ibr_ref.cli.groups import grouped, signed

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

    What `read` takes by keyword alone is no option. The command may take options in groups; where `read` does, it says so.
    """

    def decorate(command: Callable[..., Made]) -> Callable[..., Made]:
        own = grouped(command)

        @wraps(command)
        def both(*arguments: Any, **options: Any) -> Made:
            return own(*arguments, **options)

        mine = [p for p in _named(own) if p.kind is not Parameter.VAR_KEYWORD]
        others = [p for p in _named(read) if p.kind is Parameter.POSITIONAL_OR_KEYWORD]
        return signed(both, [p.replace(kind=Parameter.POSITIONAL_OR_KEYWORD) for p in (*mine, *others)])

    return decorate


def _named(function: Callable[..., Any]) -> list[Parameter]:
    """Parameters, and their annotations as what they say."""
    return list(signature(function, eval_str=True).parameters.values())
