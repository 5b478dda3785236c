"""Bugs in reading the grids of control points."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.ports.shadows.mutants.catalogue import BELOW_A_BYTE, Catalogue
from ibr_ref.oracle.ports.shadows.port import Port

fault = Catalogue("controls")


@fault("uv-exchanged", "control points are read as (v, u)")
class _Exchanged(Port):
    def controls(self) -> Floats:
        return super().controls()[..., ::-1]


@fault("column-major", "grids are read column by column")
class _ColumnMajor(Port):
    def controls(self) -> Floats:
        points = super().controls()
        three, _, rows, columns, _ = points.shape
        return points.reshape(three, three, columns, rows, 2).swapaxes(2, 3)


@fault("maps-exchanged", "the nine grids are indexed [i, j], the maps [j, i]")
class _MapsExchanged(Port):
    def controls(self) -> Floats:
        return super().controls().swapaxes(0, 1)


@fault("8-bits", "control points are held in a texture of bytes", small=True)
class _Bytes(Port):
    def controls(self) -> Floats:
        return np.rint(super().controls() * 255.0) / 255.0


@fault("half-floats", "control points are held in half floats", small=True, hidden=BELOW_A_BYTE)
class _HalfFloats(Port):
    def controls(self) -> Floats:
        return super().controls().astype(np.float16).astype(np.float64)
