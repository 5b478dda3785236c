"""How a stage's mutants are listed: each is a port with one method overridden, its docstring says what is wrong."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from ibr_ref.oracle.faults.kinds import Mutant, PlainPort

Kind = TypeVar("Kind", bound=type[Any])


class Bugs:
    """The mutants of one stage, in the order in which they are written down."""

    def __init__(self, stage: str, only: tuple[str, ...] = ()) -> None:
        """only: of the systems of which all of them are bugs; empty: all."""
        self.stage, self.only = stage, only
        self.mutants: list[Mutant] = []

    def add(
        self, name: str, *, small: bool = False, survives: str = "", hidden: str = "", only: tuple[str, ...] = ()
    ) -> Callable[[Kind], Kind]:
        """Enter the decorated class; the options are those of `Mutant`."""

        def enter(kind: Kind) -> Kind:
            fault = " ".join((kind.__doc__ or "").split())
            port = self.port(kind)
            self.mutants.append(Mutant(name, fault, self.stage, port, small, survives, hidden, only or self.only))
            return kind

        return enter

    def port(self, kind: type[Any]) -> type[PlainPort]:
        """The broken port of a decorated class: that itself."""
        return kind
