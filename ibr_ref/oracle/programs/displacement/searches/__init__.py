"""The searches that people port besides the protruded one: each a port with what it does otherwise overridden."""

from ibr_ref.oracle.programs.displacement.searches.cone import Cone, RelaxedCone
from ibr_ref.oracle.programs.displacement.searches.donnelly import Donnelly
from ibr_ref.oracle.programs.displacement.searches.maximum_mipmap import MaximumMipmap
from ibr_ref.oracle.programs.displacement.searches.mcguire import McGuire
from ibr_ref.oracle.programs.displacement.searches.relief import Relief
from ibr_ref.oracle.programs.displacement.searches.tatarchuk import Tatarchuk
from ibr_ref.oracle.programs.displacement.searches.welsh import Welsh

__all__ = ["Cone", "Donnelly", "MaximumMipmap", "McGuire", "RelaxedCone", "Relief", "Tatarchuk", "Welsh"]
