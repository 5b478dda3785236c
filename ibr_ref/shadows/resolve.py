"""Stages accumulate and resolve: the soft shadow, and the picture with it (section 3.2.3)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline import memory
from ibr_ref.pipeline.lighting import unit
from ibr_ref.pipeline.merge import blend_add
from ibr_ref.shadows.surface import Surface


def accumulate(total: Floats, shadow: Floats, count: int, unorm8: bool) -> None:
    """Add one of `count` shadows (H, W) to the sum, with alpha = 1/count."""
    blend_add(total.reshape(-1), shadow.reshape(-1), 1.0 / count, unorm8)


@device
def _brightness(
    normal: Floats, eye: Floats, lights: Lights, ambient: float, shadows: Floats, row: int, column: int, p: Floats
) -> float:
    """ambient + the sum of power (1 - ambient)(1 - shadow) max(0, n.l) of all lights, the normal turned to the eye (4,).

    normal (3,), shadows (L, H, W), p (3 or 6,): the point's varyings.
    """
    nx, ny, nz = normal[0], normal[1], normal[2]
    x, y, z, w = p[0], p[1], p[2], eye[3]
    if nx * (eye[0] - w * x) + ny * (eye[1] - w * y) + nz * (eye[2] - w * z) < 0.0:
        nx, ny, nz = -nx, -ny, -nz
    bright = ambient
    for j in range(len(shadows)):
        lx, ly, lz = unit(lights.centres[j, 0] - x, lights.centres[j, 1] - y, lights.centres[j, 2] - z)
        cosine = nx * lx + ny * ly + nz * lz
        lit = (1.0 - ambient) * (1.0 - shadows[j, row, column]) * (cosine if cosine > 0.0 else 0.0)
        bright += lights.powers[j] * lit
    return bright


@device
def _resolve_row(
    surface: Surface,
    shadows: Floats,
    eye: Floats,
    lights: Lights,
    ambient: float,
    background: Floats,
    row: int,
    color: Floats,
) -> None:
    """A row of the picture (H, W, 3): shadows (L, H, W), eye (4,), background (3,)."""
    for column in range(shadows.shape[2]):
        t = surface.triangle[row, column]
        if t < 0:
            for k in range(3):
                color[row, column, k] = background[k]
            continue
        p = surface.varyings[row, column]
        bright = _brightness(surface.normals[t], eye, lights, ambient, shadows, row, column, p)
        for k in range(3):
            plain = surface.colors[t, k]
            color[row, column, k] = (p[3 + k] if np.isnan(plain) else plain) * bright


@kernel
def _resolve(
    surface: Surface, shadows: Floats, eye: Floats, lights: Lights, ambient: float, background: Floats, color: Floats
) -> None:
    """All rows."""
    for row in prange(shadows.shape[1]):
        _resolve_row(surface, shadows, eye, lights, ambient, background, row, color)


class Lights(NamedTuple):
    """What lights add to a picture beside their shadows."""

    centres: Floats
    """(L, 3) in world space."""
    powers: Floats
    """(L,) factors of their light."""


def one_light(centre: Floats) -> Lights:
    """A light (3,) as it is."""
    return Lights(centre.reshape(1, 3), np.ones(1))


def resolve(
    surface: Surface, shadows: Floats, eye: Floats, lights: Lights, ambient: float, background: Floats
) -> Floats:
    """(H, W, 3) the picture: surface colour times brightness, for the eye (4,) and the lights with shadows (L, H, W)."""
    (color,) = memory.arrays([(np.float64, (*surface.depth.shape, 3))])
    _resolve(surface, shadows, eye, lights, ambient, background, color)
    return color
