"""Phong lighting with one light, as both stages that light something use it: fragments of a surface, and points.

Lights and eyes are homogeneous in world space: (x, y, z, 1) is a point, (x, y, z, 0) a unit direction towards it.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.jit import device


@device
def unit(x, y, z):
    """The vector divided by its length; zero stays zero."""
    length = np.sqrt(x * x + y * y + z * z)
    length = length if length > 0.0 else 1.0
    return x / length, y / length, z / length


@device
def towards(homogeneous, x, y, z):
    """Unit vector from a world point towards a homogeneous one."""
    if homogeneous[3] == 0.0:
        return homogeneous[0], homogeneous[1], homogeneous[2]
    return unit(homogeneous[0] - x, homogeneous[1] - y, homogeneous[2] - z)


@device
def power(base, exponent):
    """base^exponent by repeated squaring, lowest bit first."""
    result = 1.0
    while exponent > 0:
        if exponent & 1:
            result *= base
        base *= base
        exponent >>= 1
    return result


@device
def phong(light, eye, x, y, z, nx, ny, nz, diffuse, specular, exponent, lit):
    """What the light adds at a world point with the unit normal n: diffuse lit max(0, n.l), the highlight, and n.l.

    The highlight is specular lit max(0, r.v)^exponent where n.l > 0, with r = 2 (n.l) n - l. lit: 1, or 0 in shadow.
    """
    lx, ly, lz = towards(light, x, y, z)
    cosine = nx * lx + ny * ly + nz * lz
    shine = 0.0
    if specular > 0.0:
        ex, ey, ez = towards(eye, x, y, z)
        twice = 2.0 * cosine
        reflected = (twice * nx - lx) * ex + (twice * ny - ly) * ey + (twice * nz - lz) * ez
        gleam = power(reflected if reflected > 0.0 else 0.0, exponent)
        shine = specular * lit * gleam if cosine > 0.0 else 0.0
    bright = diffuse * lit * (cosine if cosine > 0.0 else 0.0)
    return bright, shine, cosine


@device
def lit_channel(albedo, ambient, bright, shine):
    """One channel of the colour: albedo (ambient + bright) + shine, clamped to [0, 1]."""
    colour = albedo * (ambient + bright) + shine
    colour = colour if colour > 0.0 else 0.0
    return colour if colour < 1.0 else 1.0
