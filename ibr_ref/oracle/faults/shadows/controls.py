"""Bugs in reading the grids of control points."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.faults.shadows.hidden import BELOW_A_BYTE
from ibr_ref.oracle.programs.program import Floats
from ibr_ref.oracle.programs.shadows.port import Port

CONTROLS = Bugs("controls", only=("warp",))


@CONTROLS.add("controls-uv-exchanged")
class _Exchanged(Port):
    """Control points are read as (v, u)."""

    def controls(self) -> Floats:
        return super().controls()[..., ::-1]


@CONTROLS.add("controls-column-major")
class _ColumnMajor(Port):
    """Grids are read column by column."""

    def controls(self) -> Floats:
        points = super().controls()
        three, _, rows, columns, _ = points.shape
        return points.reshape(three, three, columns, rows, 2).swapaxes(2, 3)


@CONTROLS.add("controls-maps-exchanged")
class _MapsExchanged(Port):
    """The nine grids are indexed [i, j], the maps [j, i]."""

    def controls(self) -> Floats:
        return super().controls().swapaxes(0, 1)


@CONTROLS.add("controls-8-bits", small=True)
class _Bytes(Port):
    """Control points are held in a texture of bytes."""

    def controls(self) -> Floats:
        return np.rint(super().controls() * 255.0) / 255.0


@CONTROLS.add("controls-half-floats", small=True, hidden=BELOW_A_BYTE)
class _HalfFloats(Port):
    """Control points are held in half floats."""

    def controls(self) -> Floats:
        return half(super().controls())


@CONTROLS.add("controls-v-upwards")
class _VUpwards(Port):
    """Control points are read with v upwards."""

    def controls(self) -> Floats:
        points = super().controls()
        return np.stack([points[..., 0], self.do.subtract(1.0, points[..., 1])], axis=-1)


@CONTROLS.add("controls-16-bits", small=True, hidden=BELOW_A_BYTE)
class _Of16Bits(Port):
    """Control points are held in 16 bits."""

    def controls(self) -> Floats:
        return np.rint(super().controls() * 65535.0) / 65535.0


@CONTROLS.add("controls-of-the-next-map")
class _NextMap(Port):
    """The nine grids begin with that of the second map."""

    def controls(self) -> Floats:
        points = super().controls()
        return np.stack([np.stack([points[j, (i + 1) % 3] for i in range(3)]) for j in range(3)])
