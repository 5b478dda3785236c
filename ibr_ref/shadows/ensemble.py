"""Several casters, each with its own range and place, under several lights, over the same receivers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.scene import AreaLight, Camera, Mesh, checks
from ibr_ref.shadows.inputs import Mover, Scene

MOST = 64
"""Casters, and lights."""

_Kind = TypeVar("_Kind")


@dataclass(frozen=True, kw_only=True, eq=False)
class Caster:
    """A mesh that moves; its fields are those of `Scene`, and checked there."""

    mesh: Mesh
    """Modelled about its own origin: its vertices stand at v + x a + y b."""
    offset_range: ArrayLike
    """((x0, x1), (y0, y1)), x0 < x1 and y0 < y1: where it may be."""
    offset: ArrayLike
    """(x, y) in that range: where it is."""
    offset_axes: ArrayLike = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    """(2, 3) a and b in world space; the edges of every light lie in their plane."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Ensemble:
    """Receivers, casters and lights, of which each caster and each light are a `Scene` of their own.

    Drawn are the receivers in order, then the casters; on a tie in depth the earlier one stays. Raises ValueError for
    what makes no such scene; it starts with the caster and the light where there are several.
    """

    receivers: Sequence[Mesh]
    """At least one, in world space."""
    casters: Sequence[Caster]
    """1 to 64."""
    lights: Sequence[AreaLight]
    """1 to 64. Each shows all casters in its maps, or cuts them off."""
    camera: Camera
    powers: ArrayLike | None = None
    """(L,) factors of the lights' shares of the picture, >= 0; None: 1 for each."""
    ambient: float = 0.2
    """Share of the light that reaches shadows, in [0, 1]; each light adds 1 - ambient times its power."""
    background: ArrayLike = (0.0, 0.0, 0.0)
    """(3,) linear colour where nothing is shown, in [0, 1]."""

    def __post_init__(self) -> None:
        set_field = object.__setattr__
        for name, kind in (("casters", Caster), ("lights", AreaLight)):
            set_field(self, name, _several(name, getattr(self, name), kind))
        powers = np.ones(len(self.lights)) if self.powers is None else self.powers
        set_field(self, "powers", _powers(powers, len(self.lights)))
        first = self.scene(0, 0)
        for name in ("receivers", "ambient", "background"):
            set_field(self, name, getattr(first, name))

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """(caster, light), all of them."""
        return [(i, j) for i in range(len(self.casters)) for j in range(len(self.lights))]

    @cached_property
    def _scenes(self) -> dict[tuple[int, int], Scene]:
        return {pair: self._made(*pair) for pair in self.pairs}

    def _made(self, caster: int, light: int) -> Scene:
        moved = self.casters[caster]
        with self.naming(caster, light):
            return Scene(
                receivers=self.receivers,
                caster=moved.mesh,
                light=self.lights[light],
                camera=self.camera,
                offset_range=moved.offset_range,
                offset=moved.offset,
                offset_axes=moved.offset_axes,
                ambient=self.ambient,
                background=self.background,
            )

    def scene(self, caster: int, light: int) -> Scene:
        """A caster and a light by themselves: what their maps are prepared for."""
        return self._scenes[caster, light]

    def name_of(self, caster: int, light: int) -> str:
        """What is said first about a pair: "casters[1], lights[0]: "; nothing of what there is but one."""
        names = [f"casters[{caster}]"] * (len(self.casters) > 1) + [f"lights[{light}]"] * (len(self.lights) > 1)
        return f"{', '.join(names)}: " if names else ""

    @contextmanager
    def naming(self, caster: int, light: int) -> Iterator[None]:
        """Around what is done for a pair: its errors start with its name."""
        try:
            yield
        except ValueError as error:
            raise ValueError(f"{self.name_of(caster, light)}{error}") from None

    @property
    def movers(self) -> tuple[Mover, ...]:
        """What moves, in the order in which it is drawn."""
        return tuple(self.scene(i, 0).movers[0] for i in range(len(self.casters)))


def _several(name: str, value: object, kind: type[_Kind]) -> tuple[_Kind, ...]:
    if not isinstance(value, Iterable):
        raise checks.reject(name, type(value).__name__, f"a sequence of {kind.__name__}")
    several = tuple(value)
    if not 1 <= len(several) <= MOST:
        raise checks.reject(name, len(several), f"1 to {MOST} of {kind.__name__}")
    for i, each in enumerate(several):
        if not isinstance(each, kind):
            raise checks.reject(f"{name}[{i}]", type(each).__name__, kind.__name__)
    return several


def _powers(value: ArrayLike, count: int) -> NDArray[np.float64]:
    powers = checks.vector("powers", value, count)
    for i, power in enumerate(powers.tolist()):
        checks.number(f"powers[{i}]", power, low=0.0)
    return powers
