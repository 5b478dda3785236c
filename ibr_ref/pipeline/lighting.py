"""Phong lighting with one light, as both stages that light something use it: fragments of a surface, and points.

Lights and eyes are homogeneous in world space: (x, y, z, 1) is a point, (x, y, z, 0) a unit direction towards it.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats, Lanes, Vector3, Vector4
from ibr_ref.jit import LANES, device


@device
def unit(x: float, y: float, z: float) -> Vector3:
    """The vector divided by its length; zero stays zero."""
    length = np.sqrt(x * x + y * y + z * z)
    length = length if length > 0.0 else 1.0
    return x / length, y / length, z / length


@device
def homogeneous(array: Floats) -> Vector4:
    """A homogeneous point or direction (4,) as scalars, which loops over lanes need not read again."""
    return array[0], array[1], array[2], array[3]


@device
def towards(source: Vector4, x: float, y: float, z: float) -> Vector3:
    """Unit vector from a world point towards a homogeneous one."""
    if source[3] == 0.0:
        return source[0], source[1], source[2]
    return unit(source[0] - x, source[1] - y, source[2] - z)


@device
def light_wave(
    light: Vector4, eye: Vector4, specular: float, exponent: int, x: Lanes, y: Lanes, z: Lanes, nx: Lanes,
    ny: Lanes, nz: Lanes, lit: Lanes, cosine: Lanes, power: Lanes, shine: Lanes,
) -> None:  # fmt: skip
    """n.l and the highlight of a wave: world points (x, y, z) with unit normals n, lit 1, or 0 in shadow.

    The highlight is specular lit max(0, r.v)^exponent where n.l > 0, with r = 2 (n.l) n - l, into shine, which must be 0
    before where specular is 0. The power is raised by repeated squaring, lowest bit first; `power` is room for it.
    """
    for lane in range(LANES):
        lx, ly, lz = towards(light, x[lane], y[lane], z[lane])
        cosine[lane] = nx[lane] * lx + ny[lane] * ly + nz[lane] * lz
    if not specular > 0.0:
        return
    for lane in range(LANES):
        lx, ly, lz = towards(light, x[lane], y[lane], z[lane])
        ex, ey, ez = towards(eye, x[lane], y[lane], z[lane])
        twice = 2.0 * cosine[lane]
        reflected = (twice * nx[lane] - lx) * ex + (twice * ny[lane] - ly) * ey + (twice * nz[lane] - lz) * ez
        power[lane] = reflected if reflected > 0.0 else 0.0
        shine[lane] = 1.0
    while exponent > 0:
        for lane in range(LANES if exponent & 1 else 0):
            shine[lane] *= power[lane]
        for lane in range(LANES):
            power[lane] *= power[lane]
        exponent >>= 1
    for lane in range(LANES):
        shine[lane] = specular * lit[lane] * shine[lane] if cosine[lane] > 0.0 else 0.0


@device
def lit_channel(albedo: float, ambient: float, bright: float, shine: float) -> float:
    """One channel of the colour: albedo (ambient + bright) + shine, clamped to [0, 1]."""
    colour = albedo * (ambient + bright) + shine
    colour = colour if colour > 0.0 else 0.0
    return colour if colour < 1.0 else 1.0
