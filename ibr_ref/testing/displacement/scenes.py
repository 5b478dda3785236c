"""Adversarial scenes for protruded displacement mapping, drawn by Hypothesis.

Everything is drawn in the patch space (u, v, h) of the first polygon, where the special places are known: eyes on the
very planes of the volume's faces, within it, a hair above it, lights below the horizon. Numbers are either `special`,
values that tie with something, or spread evenly. What the API rejects is not drawn, so that nothing is assumed away.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from ibr_ref.displacement import Params, Scene
from ibr_ref.displacement.patch_space import rows_of, to_patch
from ibr_ref.scene import BasePolygon, Camera
from ibr_ref.testing.displacement.shapes import Shape, neighbours, polygons, shapes, unit_shapes
from ibr_ref.testing.displacement.views import ALIGNED, EXACT_REGIONS, aligned_lights, cameras, lights
from ibr_ref.testing.numbers import often, real


@dataclass(frozen=True)
class Drawn:
    """What one frame is rendered from."""

    scene: Scene
    params: Params


def eyes_above(shape_list: list[Shape], camera: Camera) -> bool:
    """Whether the eye is above the top of every volume: faces="extended" is rejected otherwise."""
    eyes = [to_patch(rows_of(bare(shape)), shape.corner, camera.eye) for shape in shape_list]
    return all(eye[2] > eye[3] for eye in eyes)


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
    """All parameters; extended faces only where the API allows them, and the volume interval with auxiliary ones alone."""
    faces = draw(st.sampled_from(["auxiliary", "auxiliary", "base", "extended" if extendable else "auxiliary"]))
    interval = draw(st.sampled_from(["paper", "volume"])) if faces == "auxiliary" else "paper"
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
def drawn(draw: DrawFn, region: str) -> Drawn:
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
    return Drawn(scene, params)


CLEAR = ("straight above", "oblique", "far off", "beside", "inside")
"""Regions whose eyes lie on no plane of the volume: nothing that the APIs leave undefined comes up."""


@st.composite
def small(
    draw: DrawFn, pixels: SearchStrategy[tuple[int, int]], texels: SearchStrategy[tuple[int, int]], method: str
) -> Drawn:
    """A polygon, or two, with maps of few texels in a picture of few pixels, drawn by a search."""
    first = draw(shapes())
    others = [draw(neighbours(first)) for _ in range(draw(often(0, 1)))]
    camera = draw(cameras(first, draw(st.sampled_from(CLEAR)), pixels))
    params = draw(parameters(eyes_above([first, *others], camera)))
    fewest = draw(st.integers(1, 12))
    params = dataclasses.replace(
        params, method=method, min_steps=fewest, max_steps=fewest + draw(st.integers(0, 12)), lod_bias=0.0
    )
    domains = st.sampled_from(["clip", "repeat"]) if params.drawn_faces == "base" else st.just("clip")
    scene = Scene(
        polygons=[draw(polygons(shape, draw(domains), aligned=False, sizes=texels)) for shape in (first, *others)],
        camera=camera,
        light=draw(lights(first)),
        background=draw(st.tuples(*[real(0.0, 1.0)] * 3)),
    )
    return Drawn(scene, params)
