"""Phong's lighting of points in bounded numbers, with both outcomes where the sign of n.l is not certain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools
from ibr_ref.oracle.accept.bounded import Bounded, dot, exact, power, total, unit, uploaded
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import UNIT, Device
from ibr_ref.oracle.referees.splatting.place import either

Vector = Sequence[Bounded]


@dataclass(frozen=True, eq=False)
class Shades:
    """Legal colours of points."""

    color: Bounded
    """(n, 3) where n.l > 0 is decided as the reference does."""
    other: Bounded
    """(n, 3) where it is decided otherwise: without the highlight, or with it."""
    split: Bools
    """(n,) whether that is legal too."""

    def __getitem__(self, index: NDArray[np.int64]) -> Shades:
        return Shades(self.color[index], self.other[index], self.split[index])

    @property
    def branches(self) -> list[tuple[Bounded, Bools]]:
        """Both, each with where it is legal."""
        return [(self.color, np.ones_like(self.split)), (self.other, self.split)]


@dataclass(frozen=True, eq=False)
class Terms:
    """What a lit colour is made of, (n,) each."""

    facing: Bounded
    """n.l"""
    mirrored: Bounded
    """r.v"""
    shine: Bounded
    """specular max(0, r.v)^exponent."""


def shades(case: Case, device: Device, world: Vector, codes: NDArray[np.uint8], albedo: Bounded) -> Shades:
    """Colours (n, 3) of points: world positions x, y, z (n,), 8-bit normals (n, 3), stored colours (n, 3)."""
    if case.scene.light is None:
        return Shades(albedo, albedo, np.zeros(len(codes), np.bool_))
    terms = lit_terms(case, device, world, codes)
    split = (np.abs(terms.facing.value) <= terms.facing.error) & (case.scene.light.specular > 0.0)
    dark = exact(np.zeros_like(terms.shine.value), device)
    bright = terms.facing.value > 0.0
    as_reference = _colors(case.scene.light, terms.facing, terms.shine.where(bright, dark), albedo)
    if not split.any():
        return Shades(as_reference, as_reference, split)
    return Shades(as_reference, _colors(case.scene.light, terms.facing, dark.where(bright, terms.shine), albedo), split)


def lit_terms(case: Case, device: Device, world: Vector, codes: NDArray[np.uint8]) -> Terms:
    """Cosines and highlight."""
    light = case.scene.light
    normal = unit([_code(codes[:, axis], device) / exact(127.0, device) for axis in range(3)])
    towards_light = _towards(light.homogeneous, world, device)
    facing = dot(normal, towards_light)
    if not light.specular > 0.0:
        nothing = exact(np.zeros_like(facing.value), device)
        return Terms(facing, nothing, nothing)
    mirrored = _mirrored(normal, towards_light, _towards(case.scene.camera.eye, world, device), facing)
    shine = uploaded(light.specular, device) * power(mirrored.positive(), light.exponent)
    return Terms(facing, mirrored, shine)


def _code(codes: NDArray[np.uint8], device: Device) -> Bounded:
    """k - 128 of a byte that is read as an integer; or as k / 255, a quotient, times 255."""
    k = codes.astype(np.float64)
    return Bounded(k - 128.0, (device.quotient + 2.0 * device.operation) * UNIT * k, device)


def _towards(source: Any, point: Vector, device: Device) -> list[Bounded]:
    """Unit vectors to a homogeneous source; one at infinity is one already, or is made one in float arithmetic."""
    x, y, z, w = np.asarray(source, np.float64).tolist()
    if w == 0.0:
        return unit([uploaded(np.full_like(point[0].value, a), device) for a in (x, y, z)])
    return unit([uploaded(a, device) - p for a, p in zip((x, y, z), point, strict=True)])


def _mirrored(normal: Vector, light: Vector, eye: Vector, facing: Bounded) -> Bounded:
    """r.v with r = 2 (n.l) n - l, or 2 (n.l)(n.v) - l.v, which is the same: the larger error."""
    twice = exact(2.0, facing.device) * facing
    reflected = [twice * n - l for n, l in zip(normal, light, strict=True)]
    cosine = dot(reflected, eye)
    other = twice * dot(normal, eye) - dot(light, eye)
    return either(cosine, other)


def _colors(light: Any, facing: Bounded, shine: Bounded, albedo: Bounded) -> Bounded:
    """albedo (ambient + diffuse max(0, n.l)) + shine, clamped, (n, 3)."""
    device = facing.device
    ambient = uploaded(np.full_like(facing.value, light.ambient), device)
    received = ambient + uploaded(light.diffuse, device) * facing.positive()
    channels = [total([albedo[:, c] * received, shine]).between(0.0, 1.0) for c in range(3)]
    return Bounded(np.stack([c.value for c in channels], 1), np.stack([c.error for c in channels], 1), device)
