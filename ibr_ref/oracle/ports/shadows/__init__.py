"""Shadows by image warping as someone ports them from the page: `Port`, its legal `VARIANTS` and its `MUTANTS`.

`Port(scene, params, policy, {"maps": maps}).render()` gives every stage array of the contract, without the margins, and
"color" and "depth". It renders maps of its own and hands them in, but warps the maps that the case gives.
"""

from ibr_ref.oracle.ports.shadows.mutants import MUTANTS
from ibr_ref.oracle.ports.shadows.port import Port
from ibr_ref.oracle.ports.shadows.variants import VARIANTS

__all__ = ["MUTANTS", "VARIANTS", "Port"]
