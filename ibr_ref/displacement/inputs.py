"""What the method is given: a scene of base polygons, and its parameters."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.choices import DEPTHS, FACES, INTERVALS
from ibr_ref.scene import BasePolygon, Camera, Light, checks, limits
from ibr_ref.scene.documented import documented
from ibr_ref.scene.limits import Limit, Real, Whole, Word
from ibr_ref.searches import SEARCHES, read_by

METHODS = tuple(SEARCHES)
COMPARED = tuple(name for name, search in SEARCHES.items() if search.room is not None)
"""Systems with a kernel of their own (`compared`)."""
READ_BY = read_by()
"""Fields that only some methods read, and these: for the others the picture and the hits do not depend on them. (The
numbers of hits, `march.hit_index`, are of the lattice N 2^M for "exact" and "texture" too.)"""

MOST_LATTICE = 2**24
"""Largest N 2^M: the lattice of a ray, so that float32 ports can hold every index."""

MOST_STEPS = 2**16
"""Of a search whose steps depend on the view's angle."""

MOST_VOXELS = 2**26
"""Of a distance texture: half a gigabyte."""

LIMITS: dict[str, Limit] = {
    "linear_steps": Whole(1, MOST_LATTICE),
    "binary_steps": Whole(0, 24),
    "steep_threshold": Real(),
    "interval": Word(INTERVALS),
    "faces": Word(FACES),
    "depth": Word(DEPTHS),
    "method": Word(METHODS),
    "shadow_steps": Whole(0, 2**20),
    "shadow_bias": Real(low=0.0),
    "lod_bias": Real(low=0.0, high=32.0),
    "min_steps": Whole(1, MOST_STEPS),
    "max_steps": Whole(1, MOST_STEPS),
    "distance_layers": Whole(1, 1024),
}
"""Of the fields of `Params`, each by itself."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """Base polygons before a camera. Polygons are drawn in order; on a tie in depth the earlier one stays."""

    polygons: Sequence[BasePolygon]
    """At least one; `raster.patch_id` is the index here."""
    camera: Camera
    light: Light
    background: ArrayLike = (0.0, 0.0, 0.0)
    """(3,) linear colour where nothing is shown, in [0, 1]."""

    def __post_init__(self) -> None:
        if isinstance(self.polygons, BasePolygon) or not isinstance(self.polygons, Iterable):
            raise checks.reject("polygons", type(self.polygons).__name__, "a sequence of BasePolygon")
        polygons = tuple(self.polygons)
        if not polygons:
            raise checks.reject("polygons", "none", "at least one BasePolygon")
        for i, polygon in enumerate(polygons):
            if not isinstance(polygon, BasePolygon):
                raise checks.reject(f"polygons[{i}]", type(polygon).__name__, "BasePolygon")
        object.__setattr__(self, "polygons", polygons)
        for name, kind in (("camera", Camera), ("light", Light)):
            if not isinstance(getattr(self, name), kind):
                raise checks.reject(name, type(getattr(self, name)).__name__, kind.__name__)
        object.__setattr__(self, "background", checks.color("background", self.background))


@documented("method", READ_BY)
@dataclass(frozen=True, kw_only=True)
class Params:
    """Parameters of the search, named as in the paper's sections 3 and 4."""

    linear_steps: int = 10
    """N >= 1, samples of the linear search (section 3.1)."""
    binary_steps: int = 6
    """M >= 0, halvings of the binary search; N 2^M at most 2^24."""
    steep_threshold: float = 0.1
    """delta (section 4.2): a hit is on a wall if it is higher by more than this than the map was one linear step before."""
    interval: str = "paper"
    """`"paper"`: from the top of the volume to the polygon's plane; "volume": the ray's own stretch inside the volume."""
    faces: str = "auxiliary"
    """`"auxiliary"`: base and side faces (section 3.2.2); "base": figure 6c; "extended": section 3.2.1."""
    depth: str = "displaced"
    """`"displaced"`: window depth of the hit; "polygon": of the face."""
    shadow_steps: int = 0
    """S >= 0, samples towards the light; 0: no self-shadow."""
    shadow_bias: float = 1e-3
    """In units of h, >= 0."""
    method: str = "protruded"
    """The search; "exact" is the first intersection itself, all others are the systems compared with it."""
    lod_bias: float = 1.0
    """Level of the mip chain that `"mcguire"` takes heights from, in [0, 32]; fractions mix two levels."""
    min_steps: int = 8
    """Steps of `"tatarchuk"` where the view is straight down, >= 1."""
    max_steps: int = 50
    """Steps of `"tatarchuk"` where it is horizontal, at least min_steps, at most 2^16."""
    distance_layers: int = 32
    """Layers of the distance texture of `"donnelly"`, 1 to 1024; at most 2^26 voxels with the height map's texels."""

    def __post_init__(self) -> None:
        limits.check(self, LIMITS)
        if self.linear_steps << self.binary_steps > MOST_LATTICE:
            raise checks.reject("linear_steps * 2^binary_steps", self.linear_steps << self.binary_steps, "<= 2^24")
        if self.min_steps > self.max_steps:
            raise checks.reject("min_steps", self.min_steps, f"<= max_steps = {self.max_steps}")
        if self.interval == "volume" and self.faces != "auxiliary":
            raise checks.reject("faces", self.faces, 'auxiliary (with interval="volume")')

    @property
    def drawn_faces(self) -> str:
        """`faces`, but the compared systems march on the base face alone."""
        return self.faces if self.method in READ_BY["faces"] else "base"


def check(scene: Scene, params: Params) -> None:
    """What can only be checked of scene and parameters together (for the eye's height: `check_eye`)."""
    for i, polygon in enumerate(scene.polygons):
        if polygon.domain == "repeat" and params.drawn_faces != "base":
            raise checks.reject("faces", params.faces, f'base (polygons[{i}].domain is "repeat")')
        shape = np.shape(polygon.height_map)
        if params.method in READ_BY["distance_layers"] and params.distance_layers * math.prod(shape) > MOST_VOXELS:
            allowed = f"at most {MOST_VOXELS} voxels, layers x the height map's texels {shape}"
            raise checks.reject("distance_layers", params.distance_layers, allowed)


def check_eye(params: Params, eye: ArrayLike) -> None:
    """faces="extended" needs an eye (4,), in patch space, above the top of the volume."""
    _, _, height, w = np.asarray(eye, np.float64)
    if params.drawn_faces == "extended" and not height > w:
        raise checks.reject("faces", "extended", f"an eye above the volume (its height is {height:g}, the top's {w:g})")
