"""CPU reference renderer for published image-based rendering methods: the ground truth for GPU ports.

One set of conventions, so that a port in any API can be compared number by number.

**Numbers.** IEEE float64, no fused multiply-add, no fast-math; sums of products from left to right. The same bits on every
machine and for any number of threads. Colours are linear, in [0, 1]; 8 bits in: k/255, out: floor(255 c + 0.5).

**Images.** Arrays (rows, columns[, channels]), row 0 on top. Pixel (x, y) is column x, row y, its centre (x + 0.5, y + 0.5);
window y grows downwards. GL ports negate clip y rather than flip rows on read-back: a flip turns the half-open rules of
edges and squares upside down.

**Textures.** Texel (column j, row i) of W x H has its centre at ((j + 0.5)/W, (i + 0.5)/H); row 0 is v = 0. Bilinear fetch:
x = u W - 0.5, fx = x - floor(x), likewise y; lerp(lerp(t00, t10, fx), lerp(t01, t11, fx), fy) with
lerp(a, b, f) = a (1 - f) + b f; clamp or repeat. Nearest fetch: texel floor(u W), floor(v H), then the wrap mode.

**Spaces.** World and view are right-handed; the camera looks down -z, +y up, +x right. NDC: x and y in [-1, 1], y up, z in
[0, 1], 0 at the near plane. Window x = (x_ndc + 1)/2 width, y = (1 - y_ndc)/2 height, depth = z_ndc. Matrices multiply
columns and are named destination_from_source; they are applied one after the other, never multiplied together first.

**Triangles.** Window x and y rounded to 1/256 pixel (ties to even), exact integer edge functions, top-left rule, both
orientations. With E_i the edge functions at the pixel centre, a varying is (sum E_i a_i/w_i)/(sum E_i/w_i), depth
sum (E_i/sum E) z_i. Clipping in clip space: near, then far; an edge is cut from its inside vertex to its outside one, at
t = d_in/(d_in - d_out), with lerp; the polygon is fanned from its first vertex. Only where a vertex then lies more than
2^20 pixels from the centre of the picture is the polygon cut at that guard band too.

**Points.** A square splat of width w at c (rounded to 1/256 pixel) covers the centres in [c - w/2, c + w/2) on both axes.

**Depth test.** LESS, in submission order, against a buffer cleared to 1; on a tie the earlier primitive stays.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ibr_ref import displacement, io, models, oracle, shadows, splatting
    from ibr_ref.scene import BasePolygon, Camera, DepthImage, Light, Mesh

__version__ = "0.1.0"

__all__ = [
    "BasePolygon",
    "Camera",
    "DepthImage",
    "Light",
    "Mesh",
    "displacement",
    "io",
    "models",
    "oracle",
    "shadows",
    "splatting",
]

_MODULES = ("displacement", "io", "models", "oracle", "shadows", "splatting")


def __getattr__(name: str) -> Any:
    """Import on first use: `ibr-ref --help` must not wait for Numba."""
    if name in _MODULES:
        return importlib.import_module(f"ibr_ref.{name}")
    if name in __all__:
        return getattr(importlib.import_module("ibr_ref.scene"), name)
    raise AttributeError(f"module 'ibr_ref' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*globals(), *__all__]
