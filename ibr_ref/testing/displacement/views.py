"""Eyes and lights at all special places around a polygon's volume."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from ibr_ref.array_types import Floats
from ibr_ref.scene import Camera, Light
from ibr_ref.testing.displacement.shapes import Shape, points
from ibr_ref.testing.numbers import often, real

WITHIN = real(0.01, 0.99)
AROUND = real(-2.0, 3.0)
OUTSIDE = st.one_of(real(-2.0, -0.02), real(1.02, 3.0))
BEYOND = real(1.05, 4.0)
ON_PLANE = st.sampled_from([0.0, 1.0])

EYES: dict[str, SearchStrategy[Floats]] = {
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

ALIGNED: dict[str, tuple[Floats, SearchStrategy[Floats]]] = {
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


SIZES = st.tuples(st.one_of(st.integers(12, 24), st.integers(12, 24), st.sampled_from([1, 33, 40])), st.integers(9, 18))
"""Width and height of pictures."""


def up_for(forward: Floats, wanted: Floats) -> Floats:
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
    view: dict[str, Any] = {
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
def cameras(draw: DrawFn, shape: Shape, region: str, sizes: SearchStrategy[tuple[int, int]] | None = None) -> Camera:
    """A camera with its eye in a region of `EYES`, that looks at the volume of the shape.

    sizes: width and height, pixels; without, some tens. Aligned ones have sizes of their own.
    """
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
    width, height = draw(SIZES if sizes is None else sizes)
    view: dict[str, Any] = {
        "eye": eye,
        "target": target,
        "up": up_for(target - eye, axis + draw(often(0.0, 0.3, -0.8)) * axis[[2, 0, 1]]),
        "near": near,
        "far": far,
        "width": width,
        "height": height,
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
