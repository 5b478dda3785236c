"""Self-shadow: samples from the hit towards the light, against the same height map."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats, Texels, Wrap
from ibr_ref.displacement.buffers import Hits, Settings, Shades
from ibr_ref.jit import device
from ibr_ref.pipeline.sampling import fetch


@device
def _nearer(x: float, low: float, high: float, towards: float, best: float) -> float:
    """The smaller of `best` and the fraction of `towards` at which x leaves [low, high]."""
    if towards > 0.0:
        return min(best, (high - x) / towards)
    if towards < 0.0:
        return min(best, (low - x) / towards)
    return best


@device
def _stretch(
    repeat: Wrap, u: float, v: float, h: float, floor: float, towards_u: float, towards_v: float, towards_h: float,
    w: float,
) -> float:  # fmt: skip
    """Fraction of the way towards the light that lies inside the volume (repeat: below its top); 0 without a way."""
    if towards_u == 0.0 and towards_v == 0.0 and towards_h == 0.0:
        return 0.0
    t = 1.0 if w == 1.0 else np.inf
    if repeat is None:
        t = _nearer(u, 0.0, 1.0, towards_u, t)
        t = _nearer(v, 0.0, 1.0, towards_v, t)
    return _nearer(h, floor, floor + 1.0, towards_h, t)


@device
def self_shadow(
    repeat: Wrap, keep: bool | None, hits: Hits, count: int, texels: Texels, columns: float, rows: float, light: Floats,
    settings: Settings, shades: Shades,
) -> None:  # fmt: skip
    """`lit` and its margin for each kept hit; light (4,) in patch space. keep: None stops at the first sample in shadow."""
    steps, floor = settings.shadow_steps, settings.floor
    for i in range(count):
        if hits.hit_index[i] < 0:
            continue
        if light[2] <= 0.0:  # below the polygon's horizon
            shades.lit[i] = False
            continue
        u, v, h = hits.u[i], hits.v[i], hits.h[i]
        towards_u = light[0] - light[3] * u
        towards_v = light[1] - light[3] * v
        towards_h = light[2] - light[3] * h
        stretch = _stretch(repeat, u, v, h, floor, towards_u, towards_v, towards_h, light[3])
        if not stretch > 0.0:
            continue
        q_u, q_v, q_h = towards_u * stretch, towards_v * stretch, towards_h * stretch
        for j in range(1, steps + 1):
            f = j / (steps + 1)
            height = fetch(texels, columns, rows, repeat, u + q_u * f, v + q_v * f)
            level = h + q_h * f - floor + settings.shadow_bias
            shades.lit_margin[i] = min(shades.lit_margin[i], abs(level - height))
            if level < height:
                shades.lit[i] = False
                if keep is None:
                    break
