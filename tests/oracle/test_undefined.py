"""No case depends on what the APIs leave undefined: every operation of a plain port on every case is watched."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.oracle.arithmetic.device import Arithmetic, Policy
from ibr_ref.oracle.cases import Case, build, names
from ibr_ref.oracle.faults import displacement, shadows, splatting
from ibr_ref.oracle.undefined import UNDEFINED
from ibr_ref.scene import Light

FAR = 2.0**31
"""Beyond it an int has no room for a float."""

CASES = names()


class Watched(Arithmetic):
    """Counts the operations without a defined result; NaN of NaN, a port's sign of nothing, is none of them."""

    def __init__(self, policy: Policy) -> None:
        super().__init__(policy)
        self.met: Counter[str] = Counter()

    def _count(self, what: str, where: Any) -> None:
        count = int(np.count_nonzero(where))
        if count:
            self.met[what] += count

    def _made(self, what: str, result: Floats, *of: ArrayLike) -> Floats:
        numbers = np.logical_and.reduce([np.isfinite(x) for x in np.broadcast_arrays(*of)])
        self._count(f"{what} is no number", numbers & ~np.isfinite(result))
        return result

    def add(self, a: ArrayLike, b: ArrayLike) -> Floats:
        return self._made("a sum", super().add(a, b), a, b)

    def subtract(self, a: ArrayLike, b: ArrayLike) -> Floats:
        return self._made("a difference", super().subtract(a, b), a, b)

    def multiply(self, a: ArrayLike, b: ArrayLike) -> Floats:
        return self._made("a product", super().multiply(a, b), a, b)

    def divide(self, a: ArrayLike, b: ArrayLike) -> Floats:
        self._count("x / 0", np.asarray(b) == 0.0)
        return super().divide(a, b)

    def root(self, a: ArrayLike) -> Floats:
        self._count("sqrt(x), x < 0", np.asarray(a) < 0.0)
        return super().root(a)

    def unit(self, a: Sequence[ArrayLike]) -> list[Floats]:
        self._count("normalize(0)", np.logical_and.reduce([np.asarray(x) == 0.0 for x in a]))
        return super().unit(a)

    def power(self, base: ArrayLike, exponent: int) -> Floats:
        self._count("pow", (np.asarray(base) < 0.0) | ((np.asarray(base) == 0.0) & (exponent <= 0)))
        return super().power(base, exponent)

    def weight(self, fraction: Floats) -> Floats:
        self._count("a weight beyond [0, 1]", (fraction < 0.0) | (fraction > 1.0))
        return super().weight(fraction)

    def snap(self, window: ArrayLike) -> Floats:
        self._count("int(x) out of range", np.abs(window) * 2.0**self.policy.subpixel_bits >= FAR)
        return super().snap(window)


class _Displacement(displacement.Port):
    """Walls where the gradient is 0 have their own rule: the port that is watched asks for no direction there."""

    def wall_normal(self, patch: Any, hit: Any, gradient: Any) -> Any:
        watched, self.do = self.do, Arithmetic(self.do.policy)
        try:
            return super().wall_normal(patch, hit, gradient)
        finally:
            self.do = watched

    def texel_position(self, coordinate: Floats, size: int) -> Floats:
        result: Floats = super().texel_position(coordinate, size)
        self.do._count("int(x) out of range", np.abs(result) >= FAR)  # type: ignore[attr-defined]
        return result


def met(case: Case) -> dict[str, int]:
    """What the operations of a case meet, in doubles."""
    policy = Policy(float_bits=64)
    port: Any
    if case.method == "splatting":
        watched = Watched(policy)
        made: Any = splatting.Port.preparation
        preparation = type("WatchedPreparation", (made,), {"on": lambda self, do: made.on(self, watched)})
        kind: Any = type("WatchedSplatting", (splatting.Port,), {"preparation": preparation})
        kind(case.scene, case.params, policy, case.inputs).on(watched).render()
        return dict(watched.met)
    if case.method == "displacement":
        port = _Displacement(case.scene, case.params, policy, case.inputs)
        port.do = watched = Watched(policy)
    else:
        watched = Watched(policy)
        port = shadows.Port(case.scene, case.params, policy, case.inputs).on(watched)
    with np.errstate(all="ignore"):
        port.render()
    return dict(watched.met)


@pytest.mark.parametrize("name", CASES)
def test_no_case_meets_what_is_undefined(name: str) -> None:
    assert met(build(name)) == {}


def test_what_is_undefined_is_met_where_it_is() -> None:
    """The scene that a case had: the exponent 0, and highlights where r.v <= 0."""
    case = build("splatting-among")
    light = Light(position=(0.0, 0.3, -0.5), specular=0.2, exponent=0)
    object.__setattr__(case, "scene", replace(case.scene, light=light))  # past the check below
    assert met(case)["pow"] > 100


def test_a_case_with_the_exponent_0_is_refused() -> None:
    case = build("splatting-among")
    with pytest.raises(ValueError, match="exponent: found 0, allowed: 1 or more in a case"):
        replace(case, scene=replace(case.scene, light=Light(position=(0.0, 0.3, -0.5), exponent=0)))


def test_every_line_of_the_list_names_its_clause() -> None:
    assert len({line.operation for line in UNDEFINED}) == len(UNDEFINED) >= 10
    assert all(line.clause and line.where for line in UNDEFINED)
