"""How the mutants of a stage are listed: each is a port of its own, entered where it is written."""

from __future__ import annotations

from collections.abc import Callable

from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.ports.shadows.port import Port

BELOW_A_BYTE = "the picture changes by less than half a step of 8 bits: a PNG hardly shows it"


class Catalogue:
    """The mutants of one stage, in order."""

    def __init__(self, stage: str) -> None:
        self.stage = stage
        self.mutants: list[Mutant] = []

    def __call__(
        self, name: str, fault: str, *, small: bool = False, survives: str = "", hidden: str = ""
    ) -> Callable[[type[Port]], type[Port]]:
        """Enter the port below, as the stage's name and `name`."""

        def enter(port: type[Port]) -> type[Port]:
            full = f"{self.stage}-{name}"
            self.mutants.append(Mutant(full, fault, self.stage, port, small, survives, hidden))
            return port

        return enter
