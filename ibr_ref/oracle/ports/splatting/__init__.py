"""A port of splatting from its page alone: right, right in other ways, and wrong.

`Port` is a class a stage (`normals`, `atlas`, `vertex` with `lighting`, `raster`, `resolve`), each operation a method. A
variant puts another order of operations in the place of one (`orders`), a mutant one bug (`mutants`), so that the stage in
which a mutant is wrong is known by its class.
"""

from ibr_ref.oracle.ports.splatting.mutants import MUTANTS
from ibr_ref.oracle.ports.splatting.port import Port
from ibr_ref.oracle.ports.splatting.variants import VARIANTS

__all__ = ["MUTANTS", "VARIANTS", "Port"]
