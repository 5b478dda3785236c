"""Shading of the hits: albedo and normal from the maps, Phong lighting (sections 3.1 and 4.2).

Each function fills one array of the stage for all fragments of a band, in waves: slope (2, F), normal and albedo
(3, F), as in `Shades`.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats, Texels, Vector3, Wrap
from ibr_ref.displacement.buffers import Hits, Shades, Uniforms
from ibr_ref.jit import LANES, device
from ibr_ref.pipeline.fetches import fetch_color_wave, fetch_cross_wave
from ibr_ref.pipeline.lighting import homogeneous, light_wave, lit_channel, unit
from ibr_ref.pipeline.sampling import footprint, mix_channel
from ibr_ref.pipeline.waves import lanes, largest, load, load_indices, store

_LEAST_DIFFERENCE = 2.0**-16  # a smaller difference of heights is rounding, not a slope


@device
def nothing_kept(hits: Hits, first: int) -> bool:
    """Whether a wave holds discarded fragments alone: it is not shaded."""
    index = lanes()
    load_indices(hits.hit_index, first, index)
    return largest(index) < 0.0


@device
def _slope(ahead: float, behind: float, size: float) -> float:
    """Central difference of heights, per unit of the texture coordinate."""
    difference = ahead - behind
    return (0.0 if abs(difference) < _LEAST_DIFFERENCE else difference) * size / 2.0


@device
def slopes(repeat: Wrap, hits: Hits, count: int, texels: Texels, columns: float, rows: float, slope: Floats) -> None:
    """(g_u, g_v), the gradient of the height map at the hits, from one texel to either side."""
    u, v, left, right, above, below = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    g_u, g_v = lanes(), lanes()
    for first in range(0, count, LANES):
        if nothing_kept(hits, first):
            continue
        load(hits.u, first, u)
        load(hits.v, first, v)
        fetch_cross_wave(texels, columns, rows, repeat, u, v, left, right, above, below)
        for lane in range(LANES):
            g_u[lane], g_v[lane] = _slope(right[lane], left[lane], columns), _slope(below[lane], above[lane], rows)
        store(g_u, slope[0], first)
        store(g_v, slope[1], first)


@device
def height_normals(hits: Hits, count: int, constants: Uniforms, slope: Floats, normal: Floats) -> None:
    """normalize(n - s (g_u U* + g_v V*)): the surface's own normal, where there is no normal map."""
    scale, across, n = constants.scale, constants.rows, constants.frame[2]
    ux, uy, uz = across[0, 0], across[0, 1], across[0, 2]
    vx, vy, vz = across[1, 0], across[1, 1], across[1, 2]
    n0, n1, n2 = n[0], n[1], n[2]
    g_u, g_v, x, y, z = lanes(), lanes(), lanes(), lanes(), lanes()
    for first in range(0, count, LANES):
        if nothing_kept(hits, first):
            continue
        load(slope[0], first, g_u)
        load(slope[1], first, g_v)
        for lane in range(LANES):
            x[lane], y[lane], z[lane] = unit(
                n0 - scale * (g_u[lane] * ux + g_v[lane] * vx),
                n1 - scale * (g_u[lane] * uy + g_v[lane] * vy),
                n2 - scale * (g_u[lane] * uz + g_v[lane] * vz),
            )
        store(x, normal[0], first)
        store(y, normal[1], first)
        store(z, normal[2], first)


@device
def mapped_normals(
    repeat: Wrap, hits: Hits, count: int, texels: Texels, columns: float, rows: float, constants: Uniforms,
    normal: Floats,
) -> None:  # fmt: skip
    """Normals from the normal map: 2 c - 1 in the frame (U/|U|, n x U/|U|, n), normalized; a zero one is n."""
    frame = constants.frame
    tx, ty, tz = frame[0, 0], frame[0, 1], frame[0, 2]
    bx, by, bz = frame[1, 0], frame[1, 1], frame[1, 2]
    nx, ny, nz = frame[2, 0], frame[2, 1], frame[2, 2]
    u, v, x, y, z = lanes(), lanes(), lanes(), lanes(), lanes()
    for first in range(0, count, LANES):
        if nothing_kept(hits, first):
            continue
        load(hits.u, first, u)
        load(hits.v, first, v)
        fetch_color_wave(texels, columns, rows, repeat, u, v, x, y, z)
        for lane in range(LANES):
            m0, m1, m2 = 2.0 * x[lane] - 1.0, 2.0 * y[lane] - 1.0, 2.0 * z[lane] - 1.0
            zero = (m0 == 0.0) & (m1 == 0.0) & (m2 == 0.0)
            along, across, up = unit(
                m0 * tx + m1 * bx + m2 * nx, m0 * ty + m1 * by + m2 * ny, m0 * tz + m1 * bz + m2 * nz
            )
            x[lane], y[lane], z[lane] = nx if zero else along, ny if zero else across, nz if zero else up
        store(x, normal[0], first)
        store(y, normal[1], first)
        store(z, normal[2], first)


@device
def albedos(repeat: Wrap, hits: Hits, count: int, texels: Texels, columns: float, rows: float, albedo: Floats) -> None:
    """The colour map at the hits."""
    u, v, red, green, blue = lanes(), lanes(), lanes(), lanes(), lanes()
    for first in range(0, count, LANES):
        if nothing_kept(hits, first):
            continue
        load(hits.u, first, u)
        load(hits.v, first, v)
        fetch_color_wave(texels, columns, rows, repeat, u, v, red, green, blue)
        store(red, albedo[0], first)
        store(green, albedo[1], first)
        store(blue, albedo[2], first)


@device
def _horizontal(constants: Uniforms, along_u: float, along_v: float) -> Vector3:
    """along_u U + along_v V, normalized; n where that is zero (the eye straight above)."""
    axes, n = constants.axes, constants.frame[2]
    x, y, z = unit(
        along_u * axes[0, 0] + along_v * axes[1, 0],
        along_u * axes[0, 1] + along_v * axes[1, 1],
        along_u * axes[0, 2] + along_v * axes[1, 2],
    )
    return (n[0], n[1], n[2]) if x == 0.0 and y == 0.0 and z == 0.0 else (x, y, z)


@device
def _wall(constants: Uniforms, g_u: float, g_v: float, u: float, v: float) -> tuple[Vector3, bool, float]:
    """Normal of the wall at a steep hit, whether it faces u (else v), and the margin of that decision."""
    length_u, length_v = constants.lengths[0], constants.lengths[1]
    if g_u == 0.0 and g_v == 0.0:  # no slope to go by: the wall faces the eye
        d_u = constants.eye[0] - constants.eye[3] * u
        d_v = constants.eye[1] - constants.eye[3] * v
        side_u, side_v = abs(d_u) * length_u, abs(d_v) * length_v
        return _horizontal(constants, d_u, d_v), side_u >= side_v, abs(side_u - side_v)
    across = constants.rows
    normal = unit(
        -(g_u * across[0, 0] + g_v * across[1, 0]),
        -(g_u * across[0, 1] + g_v * across[1, 1]),
        -(g_u * across[0, 2] + g_v * across[1, 2]),
    )
    side_u, side_v = abs(g_u) / length_u, abs(g_v) / length_v
    return normal, side_u >= side_v, abs(side_u - side_v)


@device
def facades(
    hits: Hits, count: int, texels: Texels, columns: float, rows: float, constants: Uniforms, shades: Shades
) -> None:
    """On steep hits: the facade tile as albedo and the wall's own normal (section 4.2). Few fragments: one by one."""
    for i in range(count):
        if not hits.steep[i]:
            continue
        u, v = hits.u[i], hits.v[i]
        normal, faces_u, margin = _wall(constants, shades.slope[0, i], shades.slope[1, i], u, v)
        along = v * constants.lengths[1] if faces_u else u * constants.lengths[0]
        i00, i10, i01, i11, fx, fy = footprint(
            along / constants.tile[0], -hits.h[i] * constants.scale / constants.tile[1], columns, rows, True
        )
        shades.axis_margin[i] = margin
        for channel in range(3):
            shades.albedo[channel, i] = mix_channel(texels, np.uint32(channel), i00, i10, i01, i11, fx, fy)
            shades.normal[channel, i] = normal[channel]


@device
def light_hits(hits: Hits, count: int, constants: Uniforms, shades: Shades) -> None:
    """Phong: albedo (ambient + diffuse lit max(0, n.l)) + specular lit max(0, r.v)^e where n.l > 0."""
    light, eye = homogeneous(constants.light_world), homogeneous(constants.eye_world)
    c, a = constants.corner, constants.axes
    c0, c1, c2 = c[0], c[1], c[2]
    u0, u1, u2, v0, v1, v2 = a[0, 0], a[0, 1], a[0, 2], a[1, 0], a[1, 1], a[1, 2]
    h0, h1, h2 = a[2, 0], a[2, 1], a[2, 2]
    ambient, diffuse, specular = constants.phong[0], constants.phong[1], constants.phong[2]
    # A place in the world (first u, v, h), the normal there, lit or not; then cosine n.l and specular term.
    x, y, z, nx, ny, nz = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    lit, cosine, facing, power, shine, colour = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    for lane in range(LANES):
        shine[lane] = 0.0
    for first in range(0, count, LANES):
        if nothing_kept(hits, first):
            continue
        load(hits.u, first, x)
        load(hits.v, first, y)
        load(hits.h, first, z)
        load(shades.normal[0], first, nx)
        load(shades.normal[1], first, ny)
        load(shades.normal[2], first, nz)
        for lane in range(LANES):
            lit[lane] = 1.0 if shades.lit[np.uintp(first + lane)] else 0.0
        for lane in range(LANES):
            u, v, h = x[lane], y[lane], z[lane]
            x[lane] = c0 + u * u0 + v * v0 + h * h0
            y[lane] = c1 + u * u1 + v * v1 + h * h1
            z[lane] = c2 + u * u2 + v * v2 + h * h2
        light_wave(light, eye, specular, constants.exponent, x, y, z, nx, ny, nz, lit, cosine, power, shine)
        for lane in range(LANES):
            facing[lane] = abs(cosine[lane])
        store(facing, shades.facing_margin, first)
        for channel in range(3):
            load(shades.albedo[channel], first, colour)
            for lane in range(LANES):
                bright = diffuse * lit[lane] * (cosine[lane] if cosine[lane] > 0.0 else 0.0)
                colour[lane] = lit_channel(colour[lane], ambient, bright, shine[lane])
            store(colour, shades.color[channel], first)
