"""Bilinear fetches of whole waves: the same bits as `sampling.fetch`, lane by lane, and a third sooner.

Where to read and the mix of what was read are arithmetic, which LLVM turns into SIMD. Reading itself is no loop that may
become SIMD: each index would be taken out of a vector and each texel put into one, which is most of a fetch's time. So it
goes through the lanes' arrays (`waves.gather`).
"""

from __future__ import annotations

import numpy as np

from ibr_ref.jit import LANES, device
from ibr_ref.pipeline.sampling import footprint
from ibr_ref.pipeline.waves import gather, gather_triples, index_lanes, lanes


@device
def _footprints(columns, rows, repeat, u, v, i00, i10, i01, i11, fx, fy):
    for lane in range(LANES):
        t00, t10, t01, t11, fx[lane], fy[lane] = footprint(u[lane], v[lane], columns, rows, repeat)
        i00[lane], i10[lane] = np.int32(t00), np.int32(t10)
        i01[lane], i11[lane] = np.int32(t01), np.int32(t11)


@device
def _mix(t00, t10, t01, t11, fx, fy, out):
    for lane in range(LANES):
        top = t00[lane] * (1.0 - fx[lane]) + t10[lane] * fx[lane]
        bottom = t01[lane] * (1.0 - fx[lane]) + t11[lane] * fx[lane]
        out[lane] = top * (1.0 - fy[lane]) + bottom * fy[lane]


@device
def fetch_wave(texels, columns, rows, repeat, u, v, out):
    """A one-channel texture at a wave's (u, v), into `out`."""
    i00, i10, i01, i11 = index_lanes(), index_lanes(), index_lanes(), index_lanes()
    fx, fy = lanes(), lanes()
    t00, t10, t01, t11 = lanes(), lanes(), lanes(), lanes()
    _footprints(columns, rows, repeat, u, v, i00, i10, i01, i11, fx, fy)
    gather(texels, i00, t00)
    gather(texels, i10, t10)
    gather(texels, i01, t01)
    gather(texels, i11, t11)
    _mix(t00, t10, t01, t11, fx, fy, out)


@device
def fetch_color_wave(texels, columns, rows, repeat, u, v, red, green, blue):
    """A three-channel texture at a wave's (u, v): the channels, which lie side by side, are read together."""
    i00, i10, i01, i11 = index_lanes(), index_lanes(), index_lanes(), index_lanes()
    fx, fy = lanes(), lanes()
    r00, r10, r01, r11 = lanes(), lanes(), lanes(), lanes()
    g00, g10, g01, g11 = lanes(), lanes(), lanes(), lanes()
    b00, b10, b01, b11 = lanes(), lanes(), lanes(), lanes()
    _footprints(columns, rows, repeat, u, v, i00, i10, i01, i11, fx, fy)
    gather_triples(texels, i00, r00, g00, b00)
    gather_triples(texels, i10, r10, g10, b10)
    gather_triples(texels, i01, r01, g01, b01)
    gather_triples(texels, i11, r11, g11, b11)
    _mix(r00, r10, r01, r11, fx, fy, red)
    _mix(g00, g10, g01, g11, fx, fy, green)
    _mix(b00, b10, b01, b11, fx, fy, blue)
