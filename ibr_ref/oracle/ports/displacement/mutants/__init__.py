"""Ports of displacement mapping with one bug each, stage by stage.

A bug's stage is the first whose results are wrong on right inputs. The eye in patch space is no result that a port hands
in, so a bug in it is the march's; one in the fetches of heights is the march's too, though normals and shadows suffer as
well; colours are shading's results, and so is what writing them does. Which fragment is shown is
decided in resolve: the other stages' arrays then hold another one.
"""

from ibr_ref.oracle.ports.displacement.mutants.light import LIGHT
from ibr_ref.oracle.ports.displacement.mutants.march import MARCH
from ibr_ref.oracle.ports.displacement.mutants.raster import RASTER
from ibr_ref.oracle.ports.displacement.mutants.resolve import RESOLVE, WRITTEN
from ibr_ref.oracle.ports.displacement.mutants.search import SEARCH
from ibr_ref.oracle.ports.displacement.mutants.shade import SHADE
from ibr_ref.oracle.ports.displacement.mutants.vertex import VERTEX
from ibr_ref.oracle.ports.faults import Mutant

MUTANTS: tuple[Mutant, ...] = tuple(
    mutant for bugs in (VERTEX, RASTER, MARCH, SEARCH, SHADE, LIGHT, RESOLVE, WRITTEN) for mutant in bugs.mutants
)
"""In the order of the stages."""

__all__ = ["MUTANTS"]
