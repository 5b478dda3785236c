"""Bugs in the sum over the samples of the light."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.ports.shadows.mutants.catalogue import BELOW_A_BYTE, Catalogue
from ibr_ref.oracle.ports.shadows.port import Port

fault = Catalogue("accumulate")


@fault("one-less", "each sample weighs 1/(N - 1)")
class _OneLess(Port):
    def alpha(self, count: int) -> Floats:
        return self.ops.divide(1.0, max(1, count - 1))


@fault("three-decimals", "alpha is written with three decimals", small=True, hidden=BELOW_A_BYTE)
class _Decimals(Port):
    def alpha(self, count: int) -> Floats:
        return np.asarray(np.floor(1000.0 / count) / 1000.0)


@fault("alpha-8-bits", "alpha is rounded to a byte though the sum is a float")
class _AlphaByte(Port):
    def alpha(self, count: int) -> Floats:
        return np.asarray(np.rint(255.0 / count) / 255.0)


@fault("half-floats", "the sum is held in half floats", small=True, hidden=BELOW_A_BYTE)
class _HalfFloats(Port):
    def stored(self, value: Floats) -> Floats:
        return np.asarray(super().stored(value), np.float16).astype(np.float64)


@fault("last-left-out", "the last sample is not added")
class _LastLeftOut(Port):
    def contributions(self, shadows: list[Floats]) -> list[Floats]:
        return super().contributions(shadows)[:-1]


@fault("first-twice", "the first sample is added again in place of the last")
class _FirstTwice(Port):
    def contributions(self, shadows: list[Floats]) -> list[Floats]:
        return [*shadows[:-1], shadows[0]]


@fault("over", "samples are blended over one another: GL_ONE_MINUS_SRC_ALPHA")
class _Over(Port):
    def blended(self, total: Floats, shadow: Floats, alpha: Floats) -> Floats:
        return self.ops.lerp(total, shadow, alpha)
