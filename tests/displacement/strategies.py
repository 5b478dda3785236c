"""Adversarial scenes for protruded displacement mapping, drawn by Hypothesis.

Everything is drawn in the patch space (u, v, h) of the first polygon, where the special places are known: eyes on the
very planes of the volume's faces, within it, a hair above it, lights below the horizon. Numbers are either `special`,
values that tie with something, or spread evenly. What the API rejects is not drawn, so that nothing is assumed away.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy
from numpy.typing import NDArray

from ibr_ref.displacement import Params, Scene
from ibr_ref.scene import BasePolygon, Camera, Light
from tests.drawn import real
from tests.naive import patch as naive_patch

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """What one frame is rendered from."""

    scene: Scene
    params: Params


@dataclass(frozen=True)
class Shape:
    """Where a polygon lies: corner, edges and the height of its volume, in world units."""

    corner: Array
    edge_u: Array
    edge_v: Array
    height_scale: float

    @property
    def up(self) -> Array:
        """The edge of the volume along h."""
        normal = np.cross(self.edge_u, self.edge_v)
        return self.height_scale * normal / np.linalg.norm(normal)

    @property
    def extent(self) -> float:
        """Half of what a picture must show of the volume, in world units."""
        return 0.5 * float(np.linalg.norm(self.edge_u) + np.linalg.norm(self.edge_v))

    def vector(self, patch: Array) -> Array:
        """A direction of patch space in world space."""
        return patch[0] * self.edge_u + patch[1] * self.edge_v + patch[2] * self.up

    def point(self, patch: Array) -> Array:
        """A point of patch space in world space; exact where the polygon is a unit square at the origin."""
        return self.corner + self.vector(patch)


# --- Numbers ---------------------------------------------------------------------------------------------------------


def often(usual: Any, *others: Any) -> SearchStrategy[Any]:
    """The usual value as often as all others together."""
    return st.one_of(st.just(usual), st.sampled_from(others))


@st.composite
def points(draw: DrawFn, u: SearchStrategy[float], v: SearchStrategy[float], h: SearchStrategy[float]) -> Array:
    """A point or direction in patch space."""
    return np.array([draw(u), draw(v), draw(h)])


# --- Maps ------------------------------------------------------------------------------------------------------------

SIZES = st.one_of(
    st.sampled_from([(1, 1), (1, 2), (1, 7), (2, 1), (9, 1), (2, 2), (16, 8), (33, 17), (40, 40)]),
    st.tuples(st.integers(2, 12), st.integers(2, 12)),
)
"""Rows and columns; the larger ones have more than one level of maxima."""


@st.composite
def height_maps(draw: DrawFn) -> Array:
    """Heights from exactly 0 to exactly 1: noise, terraces, plateaus, spikes and pits of one texel, ramps."""
    size = draw(SIZES)
    random = np.random.RandomState(draw(st.integers(0, 2**16)))
    kind = draw(st.sampled_from(["noise", "terraces", "flat", "spikes", "pits", "boxes", "ramp"]))
    if kind == "noise":
        return random.random_sample(size)
    if kind == "terraces":
        return random.choice(np.array([0.0, 0.25, 0.5, 0.75, 1.0]), size)
    if kind == "flat":
        return np.full(size, draw(st.one_of(st.sampled_from([0.5, 0.0, 1.0, 0.25]), real(0.0, 1.0))))
    if kind == "ramp":
        return np.add.outer(np.linspace(0.0, 0.5, size[0]), np.linspace(0.0, 0.5, size[1]))
    ground, top = (1.0, 0.0) if kind == "pits" else (0.0, draw(real(0.2, 1.0, 1.0, 0.5)))
    heights = np.full(size, ground)
    for _ in range(draw(st.integers(1, 4))):
        row, column = random.randint(size[0]), random.randint(size[1])
        extent = random.randint(1, 2 + max(size) // 2, 2) if kind == "boxes" else (1, 1)
        heights[row : row + extent[0], column : column + extent[1]] = top
    return heights


@st.composite
def aligned_height_maps(draw: DrawFn) -> Array:
    """Quarters on maps of powers of two: their bilinear mixes are exact at the places that `ALIGNED` cameras see."""
    size = draw(st.sampled_from([(1, 1), (2, 2), (4, 4), (8, 8), (1, 4), (4, 2)]))
    if draw(st.booleans()):
        return np.full(size, draw(st.sampled_from([0.0, 0.25, 0.5, 1.0])))
    return np.random.RandomState(draw(st.integers(0, 2**16))).choice(np.array([0.0, 0.25, 0.5, 1.0]), size)


@st.composite
def colors(draw: DrawFn, most: int = 5) -> Array:
    """A map of random colours."""
    size = draw(st.tuples(st.integers(1, most), st.integers(1, most)))
    return np.random.RandomState(draw(st.integers(0, 2**16))).random_sample((*size, 3))


@st.composite
def normal_maps(draw: DrawFn) -> Array:
    """Normals as colours: noise, all zero (0.5 stands for 0), or opposite ones that cancel between the texels."""
    kind = draw(st.sampled_from(["noise", "noise", "zero", "opposite"]))
    if kind == "noise":
        return draw(colors())
    normals = np.full((4, 6, 3), 0.5)
    if kind == "opposite":
        normals[:, ::2, 0], normals[:, 1::2, 0] = 1.0, 0.0
    return normals


# --- Polygons --------------------------------------------------------------------------------------------------------


@st.composite
def unit_shapes(draw: DrawFn) -> Shape:
    """A unit square at the origin: patch space is exact there."""
    height_scale = draw(st.sampled_from([1.0, 0.5, 0.25]))
    return Shape(np.zeros(3), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), height_scale)


@st.composite
def shapes(draw: DrawFn) -> Shape:
    """Unit squares, sheared rectangles, and any parallelogram at any scale."""
    if (kind := draw(st.sampled_from(["unit", "sheared", "free", "free"]))) == "unit":
        return draw(unit_shapes())
    side = real(0.3, 2.0)
    if kind == "sheared":
        edge_v = np.array([draw(real(-1.5, 1.5)), draw(side), 0.0])
        edge_u = np.array([draw(side), 0.0, 0.0])
        return Shape(np.array([-0.5, -0.5, 0.0]), edge_u, edge_v, draw(real(0.1, 1.0)))
    world = draw(often(1.0, 0.01, 0.3, 100.0))
    edge_u = np.array(draw(st.tuples(side, real(-1.0, 1.0), real(-1.0, 1.0))))
    across = np.cross(edge_u, np.array([draw(real(-0.3, 0.3)), draw(real(-1.0, 1.0)), 1.0]))
    edge_v = draw(side) * across + draw(real(-0.7, 0.7)) * edge_u
    corner = np.array(draw(st.tuples(*[real(-3.0, 3.0)] * 3)))
    return Shape(world * corner, world * edge_u, world * edge_v, world * draw(real(0.05, 1.5)))


@st.composite
def neighbours(draw: DrawFn, first: Shape) -> Shape:
    """A polygon that may hide the first one: the next tile, one over it, one through it, or the very same again."""
    kind = draw(st.sampled_from(["beside", "over", "through", "same"]))
    if kind == "beside":
        return Shape(first.corner + first.edge_u, first.edge_u, first.edge_v, first.height_scale)
    if kind == "over":
        lift = np.array([draw(real(-0.5, 0.5)), draw(real(-0.5, 0.5)), draw(real(0.1, 1.5, 1.0))])
        return Shape(first.point(lift), first.edge_u, first.edge_v, draw(real(0.3, 1.0)) * first.height_scale)
    if kind == "through":
        corner = first.point(np.array([0.2, 0.1, draw(real(-0.5, 1.0))]))
        length = float(np.linalg.norm(first.edge_v))
        return Shape(corner, first.edge_u, first.up * (length / first.height_scale), draw(real(0.1, 0.5)) * length)
    return first


@st.composite
def polygons(draw: DrawFn, shape: Shape, domain: str, aligned: bool) -> BasePolygon:
    """The polygon of a shape, with its maps."""
    width = float(np.linalg.norm(shape.edge_u))
    return BasePolygon(
        corner=shape.corner,
        edge_u=shape.edge_u,
        edge_v=shape.edge_v,
        height_map=draw(aligned_height_maps() if aligned else height_maps()),
        color_map=draw(colors()),
        height_scale=shape.height_scale,
        normal_map=draw(st.one_of(st.none(), normal_maps())),
        facade_map=draw(colors(4) if aligned else st.one_of(st.none(), colors(4))),
        facade_tile=(width * draw(real(0.05, 2.0)), shape.height_scale * draw(real(0.05, 2.0, 1.0))),
        domain=domain,
    )


# --- Cameras and lights ----------------------------------------------------------------------------------------------

WITHIN = real(0.01, 0.99)
AROUND = real(-2.0, 3.0)
OUTSIDE = st.one_of(real(-2.0, -0.02), real(1.02, 3.0))
BEYOND = real(1.05, 4.0)
ON_PLANE = st.sampled_from([0.0, 1.0])

EYES: dict[str, SearchStrategy[Array]] = {
    "straight above": points(WITHIN, WITHIN, BEYOND),
    "oblique": points(AROUND, AROUND, BEYOND),
    "far off": points(OUTSIDE, OUTSIDE, real(1.05, 2.0)),
    "grazing the top": points(OUTSIDE, AROUND, st.sampled_from([1.0 + 1e-9, 1.0 + 1e-3, 1.02])),
    "grazing the polygon": points(AROUND, OUTSIDE, st.sampled_from([1e-9, 1e-4, 0.02])),
    "beside": points(OUTSIDE, AROUND, WITHIN),
    "inside": points(WITHIN, WITHIN, WITHIN),
    "below": points(AROUND, AROUND, real(-2.0, -0.05)),
    "on the top": points(AROUND, AROUND, st.just(1.0)),
    "on planes": points(st.one_of(ON_PLANE, AROUND), ON_PLANE, st.one_of(ON_PLANE, BEYOND)),
}
"""Where the eye is, in the patch space of the first polygon."""

SIXTEENTHS = st.integers(-4, 20).map(lambda k: k / 16.0)

ALIGNED: dict[str, tuple[Array, SearchStrategy[Array]]] = {
    "aligned from above": (
        np.array([0.0, 0.0, -1.0]),
        points(SIXTEENTHS, SIXTEENTHS, st.sampled_from([1.0, 2.0, 3.0, 4.0])),
    ),
    "aligned along u": (np.array([1.0, 0.0, 0.0]), points(st.sampled_from([-3.0, -1.0, 0.0]), SIXTEENTHS, SIXTEENTHS)),
    "aligned along v": (np.array([0.0, 1.0, 0.0]), points(SIXTEENTHS, st.sampled_from([-3.0, -1.0, 0.0]), SIXTEENTHS)),
}
"""Lines of sight along an axis and eyes on a grid: fragments, samples and hits lie exactly on borders and diagonals."""

EXACT_REGIONS = ("on the top", "on planes", *ALIGNED)
"""Regions that a rounding error would leave: the first polygon is a unit square there."""

REGIONS = (*EYES, *ALIGNED, "aligned from above")
"""All; the one with most ties twice."""


def up_for(forward: Array, wanted: Array) -> Array:
    """The wanted direction up, or another where that is nearly the line of sight."""
    sine = np.linalg.norm(np.cross(forward, wanted)) / (np.linalg.norm(forward) * np.linalg.norm(wanted))
    return wanted if sine > 0.05 else wanted[[1, 2, 0]]


@st.composite
def planes(draw: DrawFn, distance: float) -> tuple[float, float]:
    """Near and far plane: mostly around everything, else cutting the volume, or nearly at the eye itself."""
    near = draw(st.sampled_from([0.02, 0.02, 0.02, 0.5, 0.8, 1e-7, 1e-7])) * distance * draw(real(0.5, 1.2))
    return near, near + distance * draw(st.sampled_from([30.0, 30.0, 30.0, 30.0, 1.0, 1.0, 0.6]))


def calibrated(seen: Camera, skew: float, mirrored: bool) -> Camera:
    """The same view as a measured camera: sheared pixels, the centre off the middle, perhaps mirrored."""
    focal = 0.5 * seen.height * float(seen.clip_from_view[1, 1])
    intrinsics = [
        [-focal if mirrored else focal, skew * focal, 0.45 * seen.width],
        [0.0, 1.1 * focal, 0.55 * seen.height],
        [0.0, 0.0, 1.0],
    ]
    return Camera.calibrated(
        intrinsics=intrinsics,
        rotation=seen.view_from_world[:3, :3],
        translation=seen.view_from_world[:3, 3],
        near=seen.near,
        far=seen.far,
        width=seen.width,
        height=seen.height,
    )


@st.composite
def aligned_cameras(draw: DrawFn, shape: Shape, region: str) -> Camera:
    """A camera of `ALIGNED` whose pixels are powers of two wide: 90 degrees, or orthographic."""
    direction, eyes = ALIGNED[region]
    eye = shape.point(draw(eyes))
    view = {
        "eye": eye,
        "target": eye + direction,
        "up": draw(st.sampled_from([1.0, -1.0])) * direction[draw(st.sampled_from([[1, 2, 0], [2, 0, 1]]))],
        "near": 2.0**-6,
        "far": 64.0,
        "width": draw(st.sampled_from([8, 16, 32])),
        "height": draw(st.sampled_from([8, 16])),
    }
    if draw(often(True, True, False)):
        return Camera.look_at(**view, vertical_fov=90.0)
    return Camera.orthographic(**view, view_height=draw(st.sampled_from([1.0, 2.0])))


@st.composite
def cameras(draw: DrawFn, shape: Shape, region: str) -> Camera:
    """A camera with its eye in a region of `EYES`, that looks at the volume of the shape."""
    if region in ALIGNED:
        return draw(aligned_cameras(shape, region))
    eye_patch = draw(EYES[region])
    target_patch = draw(points(real(0.1, 0.9, 0.5), real(0.1, 0.9, 0.5), real(0.0, 1.0, 0.0, 0.5)))
    if np.abs(target_patch - eye_patch).max() < 0.05:
        target_patch = target_patch + 0.25
    eye, target = shape.point(eye_patch), shape.point(target_patch)
    distance = float(np.linalg.norm(target - eye))
    axis = np.eye(3)[draw(often(2, 0, 1))]
    near, far = draw(planes(distance))
    view = {
        "eye": eye,
        "target": target,
        "up": up_for(target - eye, axis + draw(often(0.0, 0.3, -0.8)) * axis[[2, 0, 1]]),
        "near": near,
        "far": far,
        "width": draw(st.one_of(st.integers(12, 24), st.integers(12, 24), st.sampled_from([1, 33, 40]))),
        "height": draw(st.integers(9, 18)),
    }
    kind = draw(often("perspective", "orthographic", "calibrated"))
    if kind == "orthographic":
        return Camera.orthographic(**view, view_height=2.0 * shape.extent * draw(real(0.2, 0.8)))
    filling = 2.0 * math.degrees(math.atan(shape.extent / distance))
    fov = filling * draw(real(0.3, 0.9)) if draw(often(True, True, False)) else draw(real(60.0, 150.0))
    camera = Camera.look_at(**view, vertical_fov=fov)
    return calibrated(camera, draw(real(-0.4, 0.4, 0.0)), draw(st.booleans())) if kind == "calibrated" else camera


@st.composite
def lights(draw: DrawFn, shape: Shape) -> Light:
    """A point or a direction, above the polygon's horizon in most cases, on it or below it in the rest."""
    height = st.one_of(real(0.2, 3.0), real(0.2, 3.0), real(-1.0, 0.5, 0.0))
    coefficients = {
        "ambient": draw(real(0.0, 1.0, 0.2)),
        "diffuse": draw(real(0.0, 2.0, 0.8)),
        "specular": draw(often(0.0, 0.3, 1.0)),
        "exponent": draw(st.one_of(st.sampled_from([0, 1, 16]), st.integers(0, 60))),
    }
    kind = draw(st.sampled_from(["direction", "direction", "near", "inside"]))
    if kind != "direction":
        place = points(WITHIN, WITHIN, WITHIN) if kind == "inside" else points(AROUND, AROUND, height)
        return Light(position=shape.point(draw(place)), **coefficients)
    towards = draw(points(real(-1.0, 1.0, 0.0), real(-1.0, 1.0, 0.0), height))
    if not towards.any():
        towards[2] = 1.0
    return Light(direction=shape.vector(towards), **coefficients)


@st.composite
def aligned_lights(draw: DrawFn, shape: Shape) -> Light:
    """A lamp on a grid, or light straight from above: with `ties`, shadow rays graze the heights exactly."""
    if draw(st.booleans()):
        return Light(direction=shape.up)
    quarters = st.integers(-2, 6).map(lambda k: k / 4.0)
    return Light(position=shape.point(draw(points(quarters, quarters, st.sampled_from([0.5, 1.0, 2.0])))), specular=0.5)


# --- Frames ----------------------------------------------------------------------------------------------------------


def eyes_above(shape_list: list[Shape], camera: Camera) -> bool:
    """Whether the eye is above the top of every volume: faces="extended" is rejected otherwise."""
    patches = [
        naive_patch.Patch(bare(shape), naive_patch.Camera(camera).eye, (0.0, 0.0, 1.0, 0.0)) for shape in shape_list
    ]
    return all(patch.eye[2] > patch.eye[3] for patch in patches)


def bare(shape: Shape) -> BasePolygon:
    """The polygon of a shape with maps of one texel."""
    return BasePolygon(
        corner=shape.corner,
        edge_u=shape.edge_u,
        edge_v=shape.edge_v,
        height_map=np.zeros((1, 1)),
        color_map=np.zeros((1, 1, 3)),
        height_scale=shape.height_scale,
    )


@st.composite
def parameters(draw: DrawFn, extendable: bool) -> Params:
    """All parameters; extended faces only where the API allows them, the volume interval as often as the paper's."""
    interval = draw(st.sampled_from(["paper", "volume"]))
    faces = "auxiliary"
    if interval == "paper":
        faces = draw(st.sampled_from(["auxiliary", "base", "extended" if extendable else "base"]))
    return Params(
        linear_steps=draw(st.one_of(st.integers(1, 20), st.sampled_from([1, 10, 40]))),
        binary_steps=draw(st.integers(0, 6)),
        steep_threshold=draw(real(0.0, 0.6, 0.1, 0.0, 0.25, -0.2)),
        interval=interval,
        faces=faces,
        depth=draw(often("displaced", "polygon")),
        shadow_steps=draw(often(0, 1, 2, 7)),
        shadow_bias=draw(st.sampled_from([1e-3, 1e-3, 0.0, 0.1])),
        method=draw(st.sampled_from(["protruded", "protruded", "protruded", "relief", "texture"])),
    )


@st.composite
def ties(draw: DrawFn, params: Params) -> Params:
    """The same on a lattice of powers of two, so that samples, heights and threshold often are the same number."""
    return dataclasses.replace(
        params,
        linear_steps=draw(st.sampled_from([1, 2, 4, 8])),
        steep_threshold=draw(st.sampled_from([-0.25, 0.0, 0.25, 0.5])),
        shadow_steps=draw(st.sampled_from([0, 1, 1, 3])),
        shadow_bias=draw(st.sampled_from([0.0, 0.0, 0.25])),
    )


@st.composite
def cases(draw: DrawFn, region: str) -> Case:
    """A whole scene and the parameters that it is rendered with; the eye in one of `REGIONS`."""
    aligned = region in ALIGNED
    first = draw(unit_shapes() if region in EXACT_REGIONS else shapes())
    others = [draw(neighbours(first)) for _ in range(draw(often(0, 1, 2)))]
    camera = draw(cameras(first, region))
    params = draw(parameters(eyes_above([first, *others], camera)))
    if aligned:
        params = draw(ties(params))
    domains = st.sampled_from(["clip", "repeat"]) if params.drawn_faces == "base" else st.just("clip")
    scene = Scene(
        polygons=[draw(polygons(shape, draw(domains), aligned)) for shape in (first, *others)],
        camera=camera,
        light=draw(aligned_lights(first) if aligned else lights(first)),
        background=draw(st.tuples(*[real(0.0, 1.0)] * 3)),
    )
    return Case(scene, params)
