"""Stages accumulate and resolve: the soft shadow, and the picture with it (section 3.2.3)."""

from __future__ import annotations

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
def _brightness(normal, eye, light, ambient, shadow, x, y, z):
    """ambient + (1 - ambient)(1 - shadow) max(0, n.l), the normal turned to the eye (4,)."""
    nx, ny, nz = normal[0], normal[1], normal[2]
    w = eye[3]
    if nx * (eye[0] - w * x) + ny * (eye[1] - w * y) + nz * (eye[2] - w * z) < 0.0:
        nx, ny, nz = -nx, -ny, -nz
    lx, ly, lz = unit(light[0] - x, light[1] - y, light[2] - z)
    cosine = nx * lx + ny * ly + nz * lz
    return ambient + (1.0 - ambient) * (1.0 - shadow) * (cosine if cosine > 0.0 else 0.0)


@device
def _resolve_row(surface, shadow, eye, light, ambient, background, row, color):
    for column in range(shadow.shape[1]):
        t = surface.triangle[row, column]
        if t < 0:
            for k in range(3):
                color[row, column, k] = background[k]
            continue
        p = surface.varyings[row, column]
        bright = _brightness(surface.normals[t], eye, light, ambient, shadow[row, column], p[0], p[1], p[2])
        for k in range(3):
            plain = surface.colors[t, k]
            color[row, column, k] = (p[3 + k] if np.isnan(plain) else plain) * bright


@kernel
def _resolve(surface, shadow, eye, light, ambient, background, color):
    for row in prange(shadow.shape[0]):
        _resolve_row(surface, shadow, eye, light, ambient, background, row, color)


def resolve(surface: Surface, shadow: Floats, eye: Floats, light: Floats, ambient: float, background: Floats) -> Floats:
    """(H, W, 3) the picture: surface colour times brightness, for the eye (4,) and the light's centre (3,)."""
    (color,) = memory.arrays([(np.float64, (*shadow.shape, 3))])
    _resolve(surface, shadow, eye, light, ambient, background, color)
    return color
