"""How a stage's mutants are listed: each is a port with one method overridden, its docstring says what is wrong."""

from __future__ import annotations

from collections.abc import Callable

from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.programs.displacement.port import Port


class Bugs:
    """The mutants of one stage, in the order in which they are written down."""

    def __init__(self, stage: str) -> None:
        self.stage = stage
        self.mutants: list[Mutant] = []

    def add(
        self, name: str, *, small: bool = False, survives: str = "", hidden: str = "", only: tuple[str, ...] = ()
    ) -> Callable[[type[Port]], type[Port]]:
        """Enter the decorated port; the options are those of `Mutant`."""

        def enter(port: type[Port]) -> type[Port]:
            fault = " ".join((port.__doc__ or "").split())
            self.mutants.append(Mutant(name, fault, self.stage, port, small, survives, hidden, only))
            return port

        return enter
