"""Known bugs of the searches below the polygon: what their ports get wrong in the march."""

from ibr_ref.oracle.faults.displacement.searches.cone import CONE
from ibr_ref.oracle.faults.displacement.searches.donnelly import DONNELLY
from ibr_ref.oracle.faults.displacement.searches.maximum_mipmap import MAXIMUM_MIPMAP
from ibr_ref.oracle.faults.displacement.searches.mcguire import MCGUIRE
from ibr_ref.oracle.faults.displacement.searches.relief import RELIEF
from ibr_ref.oracle.faults.displacement.searches.shared import SHARED
from ibr_ref.oracle.faults.displacement.searches.tatarchuk import TATARCHUK
from ibr_ref.oracle.faults.displacement.searches.welsh import WELSH

SEARCHES = (SHARED, RELIEF, WELSH, MCGUIRE, TATARCHUK, CONE, DONNELLY, MAXIMUM_MIPMAP)

__all__ = ["SEARCHES"]
