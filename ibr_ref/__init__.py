"""CPU reference renderer for published image-based rendering methods: the ground truth for GPU ports.

One set of conventions holds for all methods, so that a port in any API can be compared number by number:
`ibr-ref method conventions` prints it (`conventions.md` beside this file), and `ibr-ref method displacement | splatting |
shadows` the methods.

In short: IEEE float64, sums from left to right, the same bits on every machine; arrays (rows, columns[, channels]), row 0 on
top, window y downwards; linear colours; texture row 0 is v = 0; right-handed spaces, the camera looks down -z; NDC z in
[0, 1]; window positions snapped to 1/256 pixel, top-left rule; depth test LESS, the earlier one stays.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ibr_ref import displacement, io, metrics, models, oracle, shadows, splatting
    from ibr_ref.scene import BasePolygon, Camera, DepthImage, DepthSet, Light, Mesh

__version__ = "0.1.0"

__all__ = [
    "BasePolygon",
    "Camera",
    "DepthImage",
    "DepthSet",
    "Light",
    "Mesh",
    "displacement",
    "io",
    "metrics",
    "models",
    "oracle",
    "shadows",
    "splatting",
    "view",
]

_MODULES = ("displacement", "io", "metrics", "models", "oracle", "shadows", "splatting", "sweep")


def __getattr__(name: str) -> Any:
    """Import on first use: `ibr-ref --help` must not wait for Numba."""
    if name in _MODULES:
        return importlib.import_module(f"ibr_ref.{name}")
    if name == "view":
        return importlib.import_module("ibr_ref.viewer").view
    if name in __all__:
        return getattr(importlib.import_module("ibr_ref.scene"), name)
    raise AttributeError(f"module 'ibr_ref' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*globals(), *__all__]
