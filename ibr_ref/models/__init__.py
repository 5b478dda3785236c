"""Built-in inputs, made by formula: the same bits on every machine.

`box()` is the paper's figure 6, `city(seed)` a town in the spirit of its figures 15 and 16, `city_blocks(seed, count)`
the same town as a scene of many polygons, `buildings(seed)` the list of the wings that the town is drawn from.
"""

from ibr_ref.models.box import box
from ibr_ref.models.city import city, city_blocks
from ibr_ref.models.city_plan import buildings

__all__ = ["box", "buildings", "city", "city_blocks"]
