"""Known bugs of displacement mapping, stage by stage: broken ports, mutants and suspects.

A bug's stage is the first whose results are wrong on right inputs. The eye in patch space is no result that a port hands
in, so a bug in it is the march's; one in the fetches of heights is the march's too, though normals and shadows suffer as
well; colours are shading's results, and so is what writing them does. Which fragment is shown is
decided in resolve: the other stages' arrays then hold another one.
"""

from ibr_ref.oracle.faults.displacement.light import LIGHT
from ibr_ref.oracle.faults.displacement.march import MARCH
from ibr_ref.oracle.faults.displacement.raster import RASTER
from ibr_ref.oracle.faults.displacement.resolve import RESOLVE, WRITTEN
from ibr_ref.oracle.faults.displacement.search import SEARCH
from ibr_ref.oracle.faults.displacement.searches import SEARCHES
from ibr_ref.oracle.faults.displacement.shade import SHADE
from ibr_ref.oracle.faults.displacement.vertex import VERTEX
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.programs.displacement import Port
from ibr_ref.oracle.programs.displacement.variants import VARIANTS

MUTANTS: tuple[Mutant, ...] = tuple(
    mutant
    for bugs in (VERTEX, RASTER, MARCH, SEARCH, *SEARCHES, SHADE, LIGHT, RESOLVE, WRITTEN)
    for mutant in bugs.mutants
)
"""In the order of the stages."""

__all__ = ["MUTANTS", "VARIANTS", "Port"]
