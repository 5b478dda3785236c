"""What the method is given: receivers, a caster that moves, a light; and the parameters of maps and warps."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.choices import CONTENTS, INTERPOLATIONS, MAPPED, POLICIES, SHADOWED_BY
from ibr_ref.scene import AreaLight, Camera, Mesh, checks, limits
from ibr_ref.scene.documented import documented
from ibr_ref.scene.limits import Flag, Limit, Real, Whole, Word
from ibr_ref.scene.vectors import cross, dot, length
from ibr_ref.shadows.maps import MOST_SAMPLES

ACCUMULATIONS = ("float", "unorm8")
STORAGES = ("raw", "haar")
READ_BY: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("rows", "columns", "policy", "interpolation"), ("warp",)),
    **dict.fromkeys(("grid_size", "grid_mix", "grid_storage"), ("grid",)),
    **dict.fromkeys(("content", "map_samples", "quantize", "pcf", "light_samples"), MAPPED),
    **dict.fromkeys(("search_points", "filter_points"), ("pcss",)),
}
"""Fields of `Params` that only some methods read, and these."""
SAMPLE_COUNTS = (1, 5, 9)

MOST_LIGHT_SAMPLES = 1024
LARGEST_MAP = 4096
FINEST_MAP = 16384
"""Largest S k: maps are rendered at that size."""
MOST_CONTROLS = 256
"""Largest R and C."""
MOST_POINTS = 4096
"""Of either of the percentage-closer filter's regions."""
MOST_GRID_BYTES = 2**32
"""Of all maps of a grid."""


class Mover(NamedTuple):
    """A caster and where it is."""

    mesh: Mesh
    axes: NDArray[np.float64]
    """(2, 3)."""
    offset: NDArray[np.float64]
    """(2,)."""


LIMITS: dict[str, Limit] = {
    "map_size": Whole(8, LARGEST_MAP),
    "rows": Whole(2, MOST_CONTROLS),
    "columns": Whole(2, MOST_CONTROLS),
    "content": Word(CONTENTS),
    "map_samples": Whole(1, MOST_SAMPLES),
    "pcf": Flag(),
    "bias": Real(low=0.0),
    "policy": Word(POLICIES),
    "interpolation": Word(INTERPOLATIONS),
    "accumulation": Word(ACCUMULATIONS),
    "method": Word(SHADOWED_BY),
    "grid_size": Whole(2, 1024),
    "grid_mix": Flag(),
    "grid_storage": Word(STORAGES),
    "grid_threshold": Real(low=0.0, high=1.0),
    "search_points": Whole(1, MOST_POINTS),
    "filter_points": Whole(1, MOST_POINTS),
}
"""Of the fields of `Params`, each by itself, but for `quantize` and `light_samples`."""

_IN_PLANE = 1e-9
"""Distance from the plane of the offset axes, as a share of the vector's length, that is taken for rounding."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """Receivers, and a caster that moves along two axes between them and the light (section 3.2.2).

    Drawn are the receivers in order, then the caster; on a tie in depth the earlier one stays. Raises ValueError for axes
    that are parallel, an empty range, an offset outside it, a light whose edges leave the plane of the axes, and what is
    no mesh, light or camera.
    """

    receivers: Sequence[Mesh]
    """At least one, in world space."""
    caster: Mesh
    """Modelled about its own origin: its vertices stand at v + x a + y b."""
    light: AreaLight
    camera: Camera
    offset_range: ArrayLike
    """((x0, x1), (y0, y1)), x0 < x1 and y0 < y1: where the caster may be."""
    offset: ArrayLike
    """(x, y) in that range: where it is."""
    offset_axes: ArrayLike = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    """(2, 3) a and b in world space; they need not be unit vectors nor at right angles."""
    ambient: float = 0.2
    """Share of the light that reaches shadows, in [0, 1]."""
    background: ArrayLike = (0.0, 0.0, 0.0)
    """(3,) linear colour where nothing is shown, in [0, 1]."""

    def __post_init__(self) -> None:
        set_field = object.__setattr__
        set_field(self, "receivers", _meshes(self.receivers))
        for name, kind in (("caster", Mesh), ("light", AreaLight), ("camera", Camera)):
            if not isinstance(getattr(self, name), kind):
                raise checks.reject(name, type(getattr(self, name)).__name__, kind.__name__)
        set_field(self, "offset_axes", _axes(self.offset_axes))
        set_field(self, "offset_range", _range(self.offset_range))
        set_field(self, "offset", checks.vector("offset", self.offset, 2))
        self._check_offset()
        for i, edge in enumerate(self.light.arrays[1]):
            if not self.in_plane(edge):
                raise checks.reject(
                    f"light.half_edges[{i}]", edge.tolist(), f"a vector in the plane of offset_axes, {self._plane()}"
                )
        set_field(self, "ambient", checks.number("ambient", self.ambient, low=0.0, high=1.0))
        set_field(self, "background", checks.color("background", self.background))

    @property
    def axes(self) -> NDArray[np.float64]:
        """offset_axes as an array."""
        return np.asarray(self.offset_axes)

    @property
    def movers(self) -> tuple[Mover, ...]:
        """What moves: the caster alone."""
        return (Mover(self.caster, self.axes, np.asarray(self.offset)),)

    def _check_offset(self) -> None:
        (x0, x1), (y0, y1) = np.asarray(self.offset_range).tolist()
        x, y = np.asarray(self.offset).tolist()
        if not (x0 <= x <= x1 and y0 <= y <= y1):
            raise checks.reject(
                "offset", (x, y), f"x from {x0:g} to {x1:g} and y from {y0:g} to {y1:g}, the offset_range"
            )

    def _plane(self) -> str:
        return " and ".join(str(tuple(axis)) for axis in self.axes.tolist())

    def in_plane(self, vector: NDArray[np.float64]) -> bool:
        """Whether a (3,) vector lies in the plane of the axes, but for rounding."""
        normal = cross(*self.axes)
        return abs(dot(vector, normal)) <= _IN_PLANE * length(vector) * length(normal)

    def on_axes(self, vector: NDArray[np.float64]) -> tuple[float, float]:
        """(x, y) of the point x a + y b next to a (3,) vector."""
        a, b = self.axes
        aa, ab, bb = dot(a, a), dot(a, b), dot(b, b)
        va, vb = dot(vector, a), dot(vector, b)
        determinant = aa * bb - ab * ab
        return (bb * va - ab * vb) / determinant, (aa * vb - ab * va) / determinant


def _meshes(value: object) -> tuple[Mesh, ...]:
    if isinstance(value, Mesh) or not isinstance(value, Iterable):
        raise checks.reject("receivers", type(value).__name__, "a sequence of Mesh")
    meshes = tuple(value)
    if not meshes:
        raise checks.reject("receivers", "none", "at least one Mesh")
    for i, mesh in enumerate(meshes):
        if not isinstance(mesh, Mesh):
            raise checks.reject(f"receivers[{i}]", type(mesh).__name__, "Mesh")
    return meshes


def _axes(value: ArrayLike) -> NDArray[np.float64]:
    axes = checks.matrix("offset_axes", value, 2, 3)
    a, b = axes
    if not length(cross(a, b)) > 1e-6 * length(a) * length(b) > 0.0:
        raise checks.reject("offset_axes", axes.tolist(), "two vectors that are not zero and not parallel")
    return axes


def _range(value: ArrayLike) -> NDArray[np.float64]:
    ends = checks.matrix("offset_range", value, 2, 2)
    for name, (low, high) in zip("xy", ends.tolist(), strict=True):
        if not low < high:
            raise checks.reject("offset_range", ends.tolist(), f"{name}0 < {name}1")
    return ends


@documented("method", READ_BY)
@dataclass(frozen=True, kw_only=True, eq=False)
class Params:
    """Maps, warps and light samples; the defaults are the paper's sizes (section 4.2)."""

    map_size: int = 512
    """S, texels a side, >= 8."""
    rows: int = 15
    """R >= 2, control points downwards."""
    columns: int = 5
    """C >= 2."""
    content: str = "mask"
    """`"mask"`: the silhouette alone, the paper's; "depth": window depth, which "pcss" always has."""
    map_samples: int = 1
    """k, 1 to 15: a mask's texel is the coverage of k x k samples. Depth maps have one."""
    quantize: int | None = None
    """8: both sides of a comparison of depths are rounded to 8 bits. Masks are not compared."""
    pcf: bool = False
    """Four comparisons of depths, mixed bilinearly."""
    bias: float = 1e-3
    """Of depths, in units of window depth, >= 0; of "pcss" of distances from the light's plane, in world units."""
    policy: str = "dissolve"
    """`"dissolve"`: both neighbours are warped and mixed; "nearest": the nearer one is warped."""
    interpolation: str = "linear"
    """Pace of the control points between two maps: `"linear"`, even, the paper's; "projective": that of the caster's centre
    as the light sees it (`shadows.pace`)."""
    light_samples: int | ArrayLike = 1
    """1: the centre; 5 or 9: with points of the rectangle around it; or (N, 3) world positions in its plane."""
    accumulation: str = "float"
    """`"float"`, or "unorm8": the 8-bit frame buffer of the paper (section 3.2.3)."""
    method: str = "warp"
    """`"warp"`; "direct": a map rendered for every sample; "grid": n x n maps made beforehand (section 2.3); "pcss":
    percentage-closer soft shadows, one map for the whole light (`shadows.percentage_closer`)."""
    grid_size: int = 32
    """n >= 2, maps along either axis; for "grid" alone, as what follows."""
    grid_mix: bool = True
    """The mix of the four maps around; otherwise the nearest one."""
    grid_storage: str = "raw"
    """`"raw"`, or "haar": blocks of wavelet coefficients."""
    grid_threshold: float = 0.02
    """Wavelet coefficients below it in magnitude are dropped; in [0, 1]."""
    search_points: int = 32
    """1 to 4096: where a blocker is searched; for "pcss" alone, as what follows."""
    filter_points: int = 64
    """1 to 4096: where distances are compared, four texels each."""

    def __post_init__(self) -> None:
        limits.check(self, LIMITS)
        if self.quantize is not None:
            object.__setattr__(self, "quantize", _bits(self.quantize))
        object.__setattr__(self, "light_samples", _samples(self.light_samples))
        if self.method == "pcss":
            object.__setattr__(self, "content", "depth")
        self._check_sizes()

    def _check_sizes(self) -> None:
        if self.method == "pcss" and (not isinstance(self.light_samples, int) or self.light_samples != 1):
            found = self.light_samples if isinstance(self.light_samples, int) else "positions"
            raise checks.reject("light_samples", found, '1 with method="pcss", which takes the whole light')
        if self.map_size * self.map_samples > FINEST_MAP:
            raise checks.reject("map_size * map_samples", self.map_size * self.map_samples, f"<= {FINEST_MAP}")
        if self.method == "grid" and self.grid_bytes > MOST_GRID_BYTES:
            raise checks.reject(
                "grid_size^2 maps of map_size^2", f"{self.grid_bytes} bytes", f"<= {MOST_GRID_BYTES} bytes"
            )

    @property
    def texel_bytes(self) -> int:
        """Bytes of a texel of the prepared maps."""
        return 1 if self.content == "mask" else 8

    @property
    def grid_bytes(self) -> int:
        """Bytes of the n x n maps, raw."""
        return self.grid_size**2 * self.map_size**2 * self.texel_bytes


def _bits(value: object) -> int:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or value != 8:
        raise checks.reject("quantize", value, "None | 8")
    return 8


def _samples(value: int | ArrayLike) -> int | NDArray[np.float64]:
    allowed = f"1, 5, 9, or positions (N, 3), N from 1 to {MOST_LIGHT_SAMPLES}"
    if not isinstance(value, (Sequence, np.ndarray)):
        if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
            raise checks.reject("light_samples", value, allowed)
        if value not in SAMPLE_COUNTS:
            raise checks.reject("light_samples", int(value), allowed)
        return int(value)
    points = checks.numbers("light_samples", value, allowed)
    if points.ndim != 2 or points.shape[1] != 3 or not 1 <= len(points) <= MOST_LIGHT_SAMPLES:
        raise checks.reject("light_samples.shape", points.shape, allowed)
    if not np.isfinite(points).all():
        row = int(np.argwhere(~np.isfinite(points))[0, 0])
        raise checks.reject(f"light_samples[{row}]", points[row].tolist(), "finite numbers")
    return checks.frozen(points)
