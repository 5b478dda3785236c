"""Known bugs of shadows, stage by stage: broken ports, mutants and suspects.

A bug's stage is the first whose results are wrong on right inputs. Which surface is seen is the depth's, before what is
projected onto it; colours and what is done to the picture are resolve's.
"""

from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.faults.shadows.accumulate import ACCUMULATE
from ibr_ref.oracle.faults.shadows.comparison import COMPARISON
from ibr_ref.oracle.faults.shadows.controls import CONTROLS
from ibr_ref.oracle.faults.shadows.depth import DEPTH
from ibr_ref.oracle.faults.shadows.dissolve import DISSOLVE
from ibr_ref.oracle.faults.shadows.grid import GRID
from ibr_ref.oracle.faults.shadows.light_samples import SAMPLES
from ibr_ref.oracle.faults.shadows.lookup import LOOKUP
from ibr_ref.oracle.faults.shadows.maps import MAPS
from ibr_ref.oracle.faults.shadows.project import PROJECT
from ibr_ref.oracle.faults.shadows.resolve import RESOLVE
from ibr_ref.oracle.faults.shadows.soft import SOFT
from ibr_ref.oracle.faults.shadows.warp import WARP
from ibr_ref.oracle.programs.shadows import Port
from ibr_ref.oracle.programs.shadows.variants import VARIANTS

_BETWEEN = (DISSOLVE, WARP, SAMPLES)
"""The nine maps and the one for a place of the object."""

MUTANTS: tuple[Mutant, ...] = tuple(
    mutant
    for bugs in (MAPS, CONTROLS, *_BETWEEN, GRID, DEPTH, PROJECT, LOOKUP, COMPARISON, SOFT, ACCUMULATE, RESOLVE)
    for mutant in bugs.mutants
)
"""In the order of the stages."""

__all__ = ["MUTANTS", "VARIANTS", "Port"]
