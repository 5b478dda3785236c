"""CPU reference renderer for published image-based rendering methods: the ground truth for GPU ports."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ibr_ref import displacement, io, models
    from ibr_ref.scene import BasePolygon, Camera, Light, Mesh

__version__ = "0.1.0"

__all__ = ["BasePolygon", "Camera", "Light", "Mesh", "displacement", "io", "models"]

_MODULES = ("displacement", "io", "models")


def __getattr__(name: str) -> Any:
    """Import on first use: `ibr-ref --help` must not wait for Numba."""
    if name in _MODULES:
        return importlib.import_module(f"ibr_ref.{name}")
    if name in __all__:
        return getattr(importlib.import_module("ibr_ref.scene"), name)
    raise AttributeError(f"module 'ibr_ref' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*globals(), *__all__]
