"""The textures of a base polygon as kernels read them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement.maxima import Maxima


class Map(NamedTuple):
    """A flat texture; a map that is not there has no texels."""

    texels: NDArray[np.float64]
    columns: float
    rows: float


class Maps(NamedTuple):
    """The textures of a base polygon."""

    height: Map
    color: Map
    normal: Map
    facade: Map
    maxima: Maxima
