"""What the kernels get: a reference image, the view, the light and the law, as arrays and numbers (their uniforms)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.pipeline.memory import arrays


class Reference(NamedTuple):
    """A reference image: its maps, one texel a pixel, and the camera that saw it."""

    color: Floats
    """(P, 3) albedo; P = rows * columns."""
    depth: Floats
    """(P,) along the view axis; 0 off the mask."""
    pixels: NDArray[np.int32]
    """(V,) the valid pixels, row * columns + column, in order: its points."""
    row_starts: NDArray[np.int64]
    """(rows + 1,) where each row's share of `pixels` starts, and where the last one ends."""
    columns: int
    perspective: bool
    intrinsics: Floats
    """(3, 3), pixels."""
    world_from_view: Floats
    """(4, 4)."""
    eye: Floats
    """(4,) homogeneous, world."""


class View(NamedTuple):
    """The camera of the picture."""

    view_from_world: Floats
    """(4, 4)."""
    clip_from_view: Floats
    """(4, 4)."""
    eye: Floats
    """(4,) homogeneous, world."""
    perspective: bool
    width: float
    """Pixels."""
    height: float
    """Pixels."""


class Law(NamedTuple):
    """W_s = alpha / (beta d^2 + gamma d + delta), clamped to [least, most] pixels."""

    alpha: float
    beta: float
    gamma: float
    delta: float
    least: float
    most: float


class Lighting(NamedTuple):
    """The light, or none: then the colours are drawn as they are stored."""

    lit: bool
    light: Floats
    """(4,) homogeneous, world."""
    phong: Floats
    """(3,): ambient, diffuse, specular."""
    exponent: int


class Vertices(NamedTuple):
    """Stage vertex: where the points land, in order of (image, row, column). A dropped one: NaN, and width 0."""

    x: Floats
    """(V,) window, pixels."""
    y: Floats
    """(V,) window, pixels, downwards."""
    depth: Floats
    """(V,) window depth."""
    width: Floats
    """(V,) pixels."""


def vertices_for(count: int) -> Vertices:
    """Room for so many points."""
    return Vertices(*arrays([(np.float64, (count,))] * 4))
