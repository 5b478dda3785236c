"""Bilinear fetches of whole waves: the same bits as `sampling.fetch`, lane by lane, in a quarter of the time.

Where to read is arithmetic, which LLVM turns into SIMD. Reading is not: where the texels of all lanes lie inside the map,
they are read two at a time (`mixes`); else one by one, through arrays of lanes (`waves.gather`).
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import IndexLanes, Lanes, Texels, Wrap
from ibr_ref.jit import LANES, device, inlined
from ibr_ref.pipeline.mixes import mix_cross, mix_pairs, mix_triples
from ibr_ref.pipeline.sampling import footprint
from ibr_ref.pipeline.waves import gather, index_lanes, lanes


@inlined
def _footprints(
    columns: float, rows: float, repeat: Wrap, u: Lanes, v: Lanes, i00: IndexLanes, i10: IndexLanes, i01: IndexLanes,
    i11: IndexLanes, fx: Lanes, fy: Lanes,
) -> None:  # fmt: skip
    for lane in range(LANES):
        t00, t10, t01, t11, fx[lane], fy[lane] = footprint(u[lane], v[lane], columns, rows, repeat)
        i00[lane], i10[lane] = np.int32(t00), np.int32(t10)
        i01[lane], i11[lane] = np.int32(t01), np.int32(t11)


@inlined
def _mix(t00: Lanes, t10: Lanes, t01: Lanes, t11: Lanes, fx: Lanes, fy: Lanes, out: Lanes) -> None:
    for lane in range(LANES):
        top = t00[lane] * (1.0 - fx[lane]) + t10[lane] * fx[lane]
        bottom = t01[lane] * (1.0 - fx[lane]) + t11[lane] * fx[lane]
        out[lane] = top * (1.0 - fy[lane]) + bottom * fy[lane]


@inlined
def _inner_footprints(
    columns: float, rows: float, u: Lanes, v: Lanes, upper: IndexLanes, lower: IndexLanes, fx: Lanes, fy: Lanes
) -> bool:
    """Footprints inside the map, and whether all lie there: else those that do not name the first texel.

    A lane without a place, NaN, mixes to NaN whatever it reads.
    """
    outside = 0
    for lane in range(LANES):
        x, y = u[lane] * columns - 0.5, v[lane] * rows - 0.5
        x_floor, y_floor = np.floor(x), np.floor(y)
        fx[lane], fy[lane] = x - x_floor, y - y_floor
        inside = (x_floor >= 0.0) & (x_floor <= columns - 2.0) & (y_floor >= 0.0) & (y_floor <= rows - 2.0)
        outside += 0 if inside | np.isnan(x) | np.isnan(y) else 1
        at = y_floor * columns + x_floor
        upper[lane] = np.int32(at if inside else 0.0)
        lower[lane] = np.int32(at + columns if inside else 0.0)
    return outside == 0


@device
def fetch_wave(texels: Texels, columns: float, rows: float, repeat: Wrap, u: Lanes, v: Lanes, out: Lanes) -> None:
    """A one-channel texture at a wave's (u, v), into `out`."""
    i00, i10, i01, i11 = index_lanes(), index_lanes(), index_lanes(), index_lanes()
    fx, fy = lanes(), lanes()
    if (columns >= 2.0) & _inner_footprints(columns, rows, u, v, i00, i01, fx, fy):
        mix_pairs(texels, i00, i01, fx, fy, out)
        return
    t00, t10, t01, t11 = lanes(), lanes(), lanes(), lanes()
    _footprints(columns, rows, repeat, u, v, i00, i10, i01, i11, fx, fy)
    gather(texels, i00, t00)
    gather(texels, i10, t10)
    gather(texels, i01, t01)
    gather(texels, i11, t11)
    _mix(t00, t10, t01, t11, fx, fy, out)


@device
def fetch_color_wave(
    texels: Texels, columns: float, rows: float, repeat: Wrap, u: Lanes, v: Lanes, red: Lanes, green: Lanes, blue: Lanes
) -> None:
    """A three-channel texture at a wave's (u, v): the channels, which lie side by side, are read together."""
    i00, i10, i01, i11 = index_lanes(), index_lanes(), index_lanes(), index_lanes()
    fx, fy = lanes(), lanes()
    _footprints(columns, rows, repeat, u, v, i00, i10, i01, i11, fx, fy)
    mix_triples(texels, i00, i10, i01, i11, fx, fy, red, green, blue)


@inlined
def _crosses(
    columns: float, rows: float, u: Lanes, v: Lanes, step_u: float, step_v: float, corner: IndexLanes, fx: Lanes,
    fy: Lanes, left_fx: Lanes, right_fx: Lanes, above_fy: Lanes, below_fy: Lanes,
) -> bool:  # fmt: skip
    """What `mix_cross` is given, and whether all lanes have their four footprints side by side inside the map."""
    outside = 0
    for lane in range(LANES):
        x, y = u[lane] * columns - 0.5, v[lane] * rows - 0.5
        left, right = (u[lane] - step_u) * columns - 0.5, (u[lane] + step_u) * columns - 0.5
        above, below = (v[lane] - step_v) * rows - 0.5, (v[lane] + step_v) * rows - 0.5
        x_floor, left_floor, right_floor = np.floor(x), np.floor(left), np.floor(right)
        y_floor, above_floor, below_floor = np.floor(y), np.floor(above), np.floor(below)
        fx[lane], left_fx[lane], right_fx[lane] = x - x_floor, left - left_floor, right - right_floor
        fy[lane], above_fy[lane], below_fy[lane] = y - y_floor, above - above_floor, below - below_floor
        inside = (left_floor >= 0.0) & (right_floor <= columns - 2.0)
        inside &= (above_floor >= 0.0) & (below_floor <= rows - 2.0)
        inside &= (x_floor - left_floor == 1.0) & (right_floor - x_floor == 1.0)
        inside &= (y_floor - above_floor == 1.0) & (below_floor - y_floor == 1.0)
        outside += 0 if inside | np.isnan(x) | np.isnan(y) else 1
        corner[lane] = np.int32(above_floor * columns + left_floor if inside else 0.0)
    return outside == 0


@device
def fetch_cross_wave(
    texels: Texels, columns: float, rows: float, repeat: Wrap, u: Lanes, v: Lanes, left: Lanes, right: Lanes,
    above: Lanes, below: Lanes,
) -> None:  # fmt: skip
    """A one-channel texture one texel beside a wave's (u, v), along u and along v: at (u - 1/columns, v) and so on.

    Where rounding puts such a place into another texel than the next one, and at the borders, each is fetched by itself.
    """
    step_u, step_v = 1.0 / columns, 1.0 / rows
    corner = index_lanes()
    fx, fy, left_fx, right_fx, above_fy, below_fy = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    if (
        (columns >= 4.0)
        & (rows >= 4.0)
        & _crosses(columns, rows, u, v, step_u, step_v, corner, fx, fy, left_fx, right_fx, above_fy, below_fy)
    ):
        mix_cross(
            texels, np.int64(columns), corner, fx, fy, left_fx, right_fx, above_fy, below_fy, left, right, above, below
        )
        return
    beside = fx
    for lane in range(LANES):
        beside[lane] = u[lane] - step_u
    fetch_wave(texels, columns, rows, repeat, beside, v, left)
    for lane in range(LANES):
        beside[lane] = u[lane] + step_u
    fetch_wave(texels, columns, rows, repeat, beside, v, right)
    for lane in range(LANES):
        beside[lane] = v[lane] - step_v
    fetch_wave(texels, columns, rows, repeat, u, beside, above)
    for lane in range(LANES):
        beside[lane] = v[lane] + step_v
    fetch_wave(texels, columns, rows, repeat, u, beside, below)
