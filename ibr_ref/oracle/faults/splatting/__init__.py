"""Known bugs of splatting, stage by stage: broken ports, mutants and suspects.

A bug's stage is the first whose results are wrong on right inputs. Winners' colours are the vertex stage's; what is wrong
with the picture alone is resolve's, its depth raster's.
"""

from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.faults.splatting.atlas import ATLAS
from ibr_ref.oracle.faults.splatting.averages import AVERAGES, SUMS
from ibr_ref.oracle.faults.splatting.blends import BLENDS
from ibr_ref.oracle.faults.splatting.decoding import DECODING
from ibr_ref.oracle.faults.splatting.footprints import FOOTPRINTS
from ibr_ref.oracle.faults.splatting.gaussians import GAUSSIANS
from ibr_ref.oracle.faults.splatting.geometry import GEOMETRY
from ibr_ref.oracle.faults.splatting.law import LAW
from ibr_ref.oracle.faults.splatting.lighting import LIGHTING
from ibr_ref.oracle.faults.splatting.normals import NORMALS
from ibr_ref.oracle.faults.splatting.raster import RASTER
from ibr_ref.oracle.faults.splatting.resolve import RESOLVE
from ibr_ref.oracle.programs.splatting import Port
from ibr_ref.oracle.programs.splatting.variants import VARIANTS

MUTANTS: tuple[Mutant, ...] = tuple(
    mutant
    for bugs in (
        NORMALS,
        ATLAS,
        GEOMETRY,
        LAW,
        FOOTPRINTS,
        GAUSSIANS,
        DECODING,
        LIGHTING,
        RASTER,
        BLENDS,
        SUMS,
        RESOLVE,
        AVERAGES,
    )
    for mutant in bugs.mutants
)
"""In the order of the stages."""

__all__ = ["MUTANTS", "VARIANTS", "Port"]
