"""Adversarial sets of reference images, drawn by Hypothesis.

All points lie near the origin. Depths come from a few values, so that points tie, or differ by just the share that makes
a jump; masks have holes; pictures are a few pixels wide, so that splats reach over every border; eyes stand before, within
and behind the points. What the API rejects is not drawn, so that nothing is assumed away.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy
from numpy.typing import NDArray

from ibr_ref.scene import Camera, DepthImage, Light
from ibr_ref.splatting import Params, Scene
from ibr_ref.testing.numbers import real, seeds


@dataclass(frozen=True)
class Drawn:
    """What one frame is rendered from."""

    scene: Scene
    params: Params


@st.composite
def points(draw: DrawFn, reach: float) -> tuple[float, float, float]:
    """A point within a cube around the origin."""
    x, y, z = (draw(real(-reach, reach, 0.0, reach)) for _ in range(3))
    return x, y, z


@st.composite
def eyes(draw: DrawFn, low: float, high: float) -> NDArray[np.float64]:
    """An eye at a distance from the origin in [low, high], in any direction, often along an axis."""
    axis = st.sampled_from([(0, 0, 1), (0, 0, -1), (1, 0, 0), (0, -1, 0)])
    direction = np.array(draw(st.one_of(axis, points(1.0))), np.float64)
    length = float(np.sqrt(direction @ direction))
    direction = direction / length if length > 1e-3 else np.array([0.0, 0.0, 1.0])
    return direction * draw(real(low, high, low, high))


@st.composite
def cameras(draw: DrawFn, width: int, height: int, low: float = 2.0, high: float = 4.0) -> Camera:
    """Perspective, orthographic, axis and angle, or calibrated with sheared pixels; looking at about the origin."""
    size: dict[str, Any] = {"width": width, "height": height}
    eye = draw(eyes(low, high))
    kind = draw(st.sampled_from(["perspective", "perspective", "orthographic", "axis-angle", "calibrated"]))
    near = draw(real(0.05, 3.0, 0.05, 2.0))
    planes: dict[str, Any] = {"near": near, "far": near + draw(real(0.5, 8.0, 8.0, 1.0))}
    if kind == "axis-angle":
        flat = draw(st.booleans())
        return Camera.axis_angle(
            position=(0.0, 0.0, float(np.sqrt(eye @ eye))),
            orientation=(0.0, 1.0, 0.0, draw(real(-0.3, 0.3, 0.0))),
            field_of_view=(2.0, 2.0) if flat else (0.8, 0.7),
            orthographic=flat,
            **planes,
            **size,
        )
    look = Camera.look_at(eye=eye, target=draw(points(0.2)), up=_up(eye), vertical_fov=40.0, **planes, **size)
    if kind == "perspective":
        return look
    if kind == "orthographic":
        return Camera.orthographic(eye=eye, target=(0, 0, 0), up=_up(eye), view_height=2.0, **planes, **size)
    k = look.intrinsics + np.array([[0.3, draw(real(-0.5, 0.5)), 0.25], [0.0, -0.2, -0.125], [0.0, 0.0, 0.0]])
    view = look.view_from_world
    measured = view[:3, :3] + 1e-4 * np.array([[0.1, -0.2, 0.3], [0.2, 0.1, -0.1], [-0.3, 0.2, 0.1]])
    return Camera.calibrated(intrinsics=k, rotation=measured, translation=view[:3, 3], **planes, **size)


def _up(eye: NDArray[np.float64]) -> tuple[float, float, float]:
    return (0.0, 0.0, 1.0) if abs(eye[0]) + abs(eye[1]) > 1e-6 else (0.0, 1.0, 0.0)


@st.composite
def depth_images(draw: DrawFn) -> DepthImage:
    """A small picture: one pixel, a row, a column, or a rectangle; half of them with a mask."""
    width, height = draw(st.sampled_from([(1, 1), (5, 1), (1, 4), (3, 3), (6, 4), (7, 5)]))
    camera = draw(cameras(width, height))
    middle = draw(real(1.5, 4.0, 3.0))
    jump = middle * 1.05  # the farthest that still is a neighbour
    levels = [middle, middle, jump, np.nextafter(jump, np.inf), 1.2 * middle, 0.98 * middle]
    flat = draw(st.booleans())
    random = np.random.RandomState(draw(seeds()))
    mask = {
        "none": None,
        "holes": random.random_sample((height, width)) < 0.5,
        "nothing": np.zeros((height, width), np.bool_),
    }[draw(st.sampled_from(["none", "none", "none", "holes", "holes", "holes", "nothing"]))]
    grey = np.clip(random.uniform(-0.25, 1.25, (height, width, 1)), 0.0, 1.0)  # often black, and white
    return DepthImage(
        color=grey * np.array([1.0, 0.5, 0.25]) + np.array([0.0, 0.25, 0.0]),
        depth=np.full((height, width), middle) if flat else random.choice(levels, (height, width)),
        camera=camera,
        mask=mask,
    )


def lights() -> SearchStrategy[Light | None]:
    """None, a lamp or a direction, with and without a highlight."""
    shine = {"specular": real(0.0, 1.0, 0.0), "exponent": st.sampled_from([0, 1, 16, 37])}
    return st.one_of(
        st.none(),
        st.builds(Light, position=points(4.0), **shine),
        st.builds(Light, direction=points(1.0).filter(any), ambient=real(0.0, 1.0), **shine),
    )


@st.composite
def laws(draw: DrawFn) -> dict[str, Any]:
    """Constant widths from below a pixel to hundreds of them, and laws that fall with the distance, clamped or not."""
    if draw(st.booleans()):
        width = draw(real(0.25, 12.0, 1.0, 2.0, 0.5, 300.0))
        return {"alpha": width, "min_width": 0.0, "max_width": 512.0}
    least = draw(real(0.0, 2.0, 0.0, 1.0))
    return {
        "alpha": draw(real(0.1, 40.0)),
        "beta": draw(real(0.0, 1.0, 0.0)),
        "gamma": draw(real(0.0, 2.0, 0.0)),
        "delta": draw(real(0.01, 1.0, 1.0)),
        "min_width": least,
        "max_width": least + draw(real(0.0, 30.0, 0.0)),
    }


@st.composite
def drawn(draw: DrawFn) -> Drawn:
    """One to three reference images before a camera of a few pixels."""
    images = draw(st.lists(depth_images(), min_size=1, max_size=3))
    if len(images) > 1 and draw(st.booleans()):
        images[1] = images[0]  # every point ties with its double
    if not any(np.any(image.mask) for image in images):
        images.append(DepthImage(color=np.ones((1, 1, 3)), depth=np.full((1, 1), 3.0), camera=draw(cameras(1, 1))))
    width, height = draw(st.sampled_from([(1, 1), (9, 7), (12, 10), (16, 3)]))
    camera = draw(st.one_of(cameras(width, height, 0.4, 1.2), cameras(width, height), cameras(width, height)))
    background = (draw(real(0.0, 1.0, 0.0)), 0.5, 0.25)
    scene = Scene(images=images, camera=camera, light=draw(lights()), background=background)
    widest = max(max(np.shape(image.depth)) for image in images)
    shape, limit = (
        draw(st.sampled_from(["square", "square", "disc"])),
        draw(st.sampled_from([widest, widest + 1, 4096])),
    )
    return Drawn(scene, Params(**draw(laws()), shape=shape, max_atlas_size=limit))
