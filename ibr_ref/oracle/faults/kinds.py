"""What the oracle is tried on: ports that are right in their own way, and ports with one bug each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.arithmetic.device import Policy


class PlainPort(Protocol):
    """A method as someone ports it: every operation that a bug can hide in is a method of its own."""

    def __init__(self, scene: Any, params: Any, policy: Policy, inputs: dict[str, Any]) -> None:
        """Take the case: its scene, its parameters, and what else it hands over (prepared maps, normal codes)."""

    def render(self) -> dict[str, NDArray[np.generic]]:
        """All arrays that a port can hand in, by their names in the contract, with "color" and "depth"."""


@dataclass(frozen=True)
class Variant:
    """A legal port."""

    name: str
    policy: Policy
    profile: str
    """The tightest device profile that explains it."""
    port: type[PlainPort] | None = None
    """Where it also computes in another order; None: the plain port."""
    own: tuple[str, ...] = ()
    """Of what the case hands over, the arrays that it makes itself and goes on with: handed in, beside a picture too."""
    coarse: bool = False
    """Its device has fewer bits or more freedom than desktops': mutants are tried on it as well (`coarse.py`)."""


@dataclass(frozen=True)
class Mutant:
    """A port with one bug."""

    name: str
    fault: str
    """What is wrong, in words."""
    stage: str
    """The stage in which it is wrong: the first that the oracle should name."""
    port: type[PlainPort]
    small: bool = False
    """Meant to be hard to see: below 1/255, or on fewer than 1 % of the pixels."""
    survives: str = ""
    """Why no case can kill it with stages; empty: it should be killed."""
    hidden: str = ""
    """Why the final image alone cannot show it."""
    only: tuple[str, ...] = ()
    """The systems (`Method.judged`) that it is a bug of; empty: all."""

    def applies(self, system: str) -> bool:
        """Whether a port of the system can have it."""
        return not self.only or system in self.only
