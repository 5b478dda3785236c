"""The searches that people port besides the protruded one: each a port with what it does otherwise overridden."""

from __future__ import annotations

from functools import cache
from typing import Any

from ibr_ref.oracle.programs.displacement.port import Port
from ibr_ref.oracle.programs.displacement.searches.cone import Cone, RelaxedCone
from ibr_ref.oracle.programs.displacement.searches.mcguire import McGuire
from ibr_ref.oracle.programs.displacement.searches.relief import Relief
from ibr_ref.oracle.programs.displacement.searches.tatarchuk import Tatarchuk
from ibr_ref.oracle.programs.displacement.searches.welsh import Welsh
from ibr_ref.scene.checks import choice

PROGRAMS: dict[str, type[Port]] = {
    "protruded": Port,
    "relief": Relief,
    "welsh": Welsh,
    "mcguire": McGuire,
    "tatarchuk": Tatarchuk,
    "cone": Cone,
    "relaxed_cone": RelaxedCone,
}
"""By `Params.method`."""


@cache
def searching(kind: type[Any], method: str) -> type[Any]:
    """A kind of port with a search: what the kind overrides comes first, then the search's own.

    Raises ValueError for a search that has no program, and TypeError for a kind that is another search's alone.
    """
    choice("method", method, tuple(PROGRAMS))
    search = PROGRAMS[method]
    if issubclass(kind, search):
        return kind
    if issubclass(search, kind):
        return search
    others = [name for name, other in PROGRAMS.items() if issubclass(kind, other) and not issubclass(search, other)]
    if others:
        raise TypeError(f"{kind.__name__}: found method = {method!r}, allowed: {' | '.join(others)}")
    return type(kind.__name__, (kind, search), {"__doc__": kind.__doc__, "__module__": kind.__module__})
