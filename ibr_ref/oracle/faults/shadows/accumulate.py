"""Bugs in the sum over the samples of the light."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.faults.shadows.hidden import BELOW_A_BYTE
from ibr_ref.oracle.programs.program import Floats, Vector
from ibr_ref.oracle.programs.shadows.port import Port

ACCUMULATE = Bugs("accumulate")


@ACCUMULATE.add("accumulate-one-less")
class _OneLess(Port):
    """Each sample weighs 1/(N - 1)."""

    def alpha(self, count: int) -> Floats:
        return self.do.divide(1.0, max(1, count - 1))


@ACCUMULATE.add("accumulate-three-decimals", small=True, hidden=BELOW_A_BYTE)
class _Decimals(Port):
    """Alpha is written with three decimals."""

    def alpha(self, count: int) -> Floats:
        return np.floor(1000.0 / count) / 1000.0


@ACCUMULATE.add("accumulate-alpha-8-bits")
class _AlphaByte(Port):
    """Alpha is rounded to a byte though the sum is a float."""

    def alpha(self, count: int) -> Floats:
        return np.rint(255.0 / count) / 255.0


@ACCUMULATE.add("accumulate-half-floats", small=True, hidden=BELOW_A_BYTE)
class _HalfFloats(Port):
    """The sum is held in half floats."""

    def stored(self, value: Floats) -> Floats:
        return self.do.rising(half, super().stored(value))


@ACCUMULATE.add("accumulate-last-left-out")
class _LastLeftOut(Port):
    """The last sample is not added."""

    def contributions(self, shadows: Vector) -> Vector:
        return super().contributions(shadows)[:-1]


@ACCUMULATE.add("accumulate-first-twice")
class _FirstTwice(Port):
    """The first sample is added again in place of the last."""

    def contributions(self, shadows: Vector) -> Vector:
        return [*shadows[:-1], shadows[0]]


@ACCUMULATE.add("accumulate-over")
class _Over(Port):
    """Samples are blended over one another: GL_ONE_MINUS_SRC_ALPHA."""

    def blended(self, total: Floats, shadow: Floats, alpha: Floats) -> Floats:
        return self.do.lerp(total, shadow, alpha)


@ACCUMULATE.add("accumulate-alpha-twice")
class _AlphaTwice(Port):
    """Shadows are premultiplied by alpha and blended by it again."""

    def blended(self, total: Floats, shadow: Floats, alpha: Floats) -> Floats:
        return super().blended(total, self.do.multiply(shadow, alpha), alpha)


@ACCUMULATE.add("accumulate-not-weighted")
class _NotWeighted(Port):
    """Blending is (one, one): the samples are added, not averaged."""

    def blended(self, total: Floats, shadow: Floats, alpha: Floats) -> Floats:
        return self.do.add(total, shadow)


@ACCUMULATE.add("accumulate-maximum")
class _Maximum(Port):
    """The blend equation is MAX."""

    def blended(self, total: Floats, shadow: Floats, alpha: Floats) -> Floats:
        return np.maximum(total, shadow)


@ACCUMULATE.add("accumulate-shadow-squared")
class _ShadowSquared(Port):
    """The shadow is its own alpha: it is multiplied by itself."""

    def blended(self, total: Floats, shadow: Floats, alpha: Floats) -> Floats:
        return super().blended(total, self.do.multiply(shadow, shadow), alpha)


@ACCUMULATE.add("accumulate-last-alone")
class _LastAlone(Port):
    """Blending is off: the last sample stays."""

    def blended(self, total: Floats, shadow: Floats, alpha: Floats) -> Floats:
        return 1.0 * shadow


@ACCUMULATE.add("accumulate-cleared-to-white")
class _ClearedToWhite(Port):
    """The sum is cleared to 1/N, not to 0."""

    def summed(self, shadows: list[Floats], alpha: Floats, total: Floats) -> Floats:
        return super().summed(shadows, alpha, total + self.alpha(len(shadows)))
