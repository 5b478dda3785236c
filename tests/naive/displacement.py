"""displacement/method.md: protruded displacement mapping, relief and texture mapping, pixel by pixel.

`stages, color, depth = render(scene, params)`. Clarity first: read it beside the page.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from .march import March, march_fragment
from .patch import Camera, Light, Patch
from .raster import triangle_fragments
from .shade import shade_hit
from .vectors import Vec3, Vec4, towards, vec3

Quad = list[Vec3]
Arrays = dict[str, np.ndarray]

BASE, U0, U1, V0, V1, TOP = range(6)

QUADS: dict[int, Quad] = {
    BASE: [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)],
    U0: [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 1.0, 1.0), (0.0, 0.0, 1.0)],
    U1: [(1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (1.0, 1.0, 1.0), (1.0, 0.0, 1.0)],
    V0: [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.0, 1.0), (0.0, 0.0, 1.0)],
    V1: [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0), (1.0, 1.0, 1.0), (0.0, 1.0, 1.0)],
    TOP: [(0.0, 0.0, 1.0), (1.0, 0.0, 1.0), (1.0, 1.0, 1.0), (0.0, 1.0, 1.0)],
}


@dataclass
class Fragment:
    """One covered pixel of one triangle, with its march stage and (where it is kept) its window depth."""

    face: int
    patch_id: int
    c: Vec3
    march: March
    depth: float


# --- 1. vertex -------------------------------------------------------------------------------------------------------


def faces_away_from_eye(eye: Vec4) -> list[int]:
    """The faces of the unit cube that face away from the homogeneous patch-space eye, in face-number order."""
    u, v, h, w = eye
    tests = [(BASE, h > 0.0), (U0, u > 0.0), (U1, u < w), (V0, v > 0.0), (V1, v < w), (TOP, h < w)]
    return [face for face, away in tests if away]


def faces_to_draw(patch: Patch, params: Any) -> list[tuple[int, Quad]]:
    """The faces of one polygon as (face number, quad)."""
    away = faces_away_from_eye(patch.eye)
    if params.method == "protruded" and params.faces == "extended":
        return [(BASE, extended_quad(patch.eye))]
    if params.method != "protruded" or params.faces == "base":
        drawn = [face for face in away if face == BASE]
    elif params.interval == "volume":
        drawn = away
    else:
        drawn = [face for face in away if face != TOP]
    return [(face, QUADS[face]) for face in drawn]


def extended_quad(eye: Vec4) -> Quad:
    """Section 3.2.1: the rectangle around the polygon and the projections of the four top corners onto h = 0."""
    if eye[2] <= eye[3]:
        raise ValueError(f"faces: 'extended' needs the eye above the volume, its height in the patch is {eye[2]}")
    us, vs = [0.0, 1.0], [0.0, 1.0]
    for corner in QUADS[TOP]:
        v = towards(eye, corner)
        factor = 1.0 / v[2]
        us.append(corner[0] - v[0] * factor)
        vs.append(corner[1] - v[1] * factor)
    u_min, u_max, v_min, v_max = min(us), max(us), min(vs), max(vs)
    return [(u_min, v_min, 0.0), (u_max, v_min, 0.0), (u_max, v_max, 0.0), (u_min, v_max, 0.0)]


# --- 2. raster and 3. march ------------------------------------------------------------------------------------------


def face_fragments(
    patch: Patch, patch_id: int, face: int, quad: Quad, clips: list[Vec4], camera: Camera, params: Any
) -> list[tuple[int, int, Fragment]]:
    """The fragments of one face, drawn as the triangles abc and acd: (column, row, fragment)."""
    vertices = [[*clip, *corner] for clip, corner in zip(clips, quad, strict=True)]
    result = []
    for second in (1, 2):
        triangle = vertices[0], vertices[second], vertices[second + 1]
        for column, row, polygon_depth, values in triangle_fragments(*triangle, camera.width, camera.height):
            c = vec3(values)
            march = march_fragment(c, patch, camera, params)
            depth = fragment_depth(march, polygon_depth, patch, camera, params)
            result.append((column, row, Fragment(face, patch_id, c, march, depth)))
    return result


def fragment_depth(march: March, polygon_depth: float, patch: Patch, camera: Camera, params: Any) -> float:
    """Window depth: the hit's, or with depth="polygon" the face's; NaN where the fragment is discarded."""
    if march.hit is None:
        return math.nan
    if params.depth == "polygon":
        return polygon_depth
    clip = camera.clip_position(patch.to_world(march.hit))
    return clip[2] / clip[3]


# --- 5. resolve ------------------------------------------------------------------------------------------------------


def shown_fragment(fragments: list[Fragment]) -> Fragment | None:
    """Depth test LESS against a buffer cleared to 1, in submission order."""
    shown, nearest = None, 1.0
    for fragment in fragments:
        if fragment.march.hit is not None and fragment.depth < nearest:
            shown, nearest = fragment, fragment.depth
    return shown


def resolve_margin(shown: Fragment | None, fragments: list[Fragment]) -> float:
    """The distance in depth from the shown fragment to the nearest other kept one."""
    margin = math.inf
    for other in fragments:
        if shown is not None and other is not shown and other.march.hit is not None:
            margin = min(margin, abs(shown.depth - other.depth))
    return margin


# --- Stage arrays ----------------------------------------------------------------------------------------------------


def empty_stages(height: int, width: int) -> Arrays:
    """Every per-pixel stage array, filled with its "nothing here"."""
    stages: Arrays = {}
    for name in ("raster.face", "raster.patch_id", "march.linear_index", "march.hit_index"):
        stages[name] = np.full((height, width), -1, dtype=np.int32)
    for name in ("raster.patch", "march.hit", "shade.albedo", "shade.normal"):
        stages[name] = np.full((height, width, 3), np.nan)
    for name in (
        *("march.height_before", "march.margin", "march.domain_margin", "march.steep_margin"),
        *("shade.lit_margin", "shade.axis_margin", "shade.facing_margin", "resolve.margin"),
    ):
        stages[name] = np.full((height, width), np.nan)
    for name in ("march.steep", "shade.lit"):
        stages[name] = np.zeros((height, width), dtype=np.bool_)
    return stages


def store_fragment(stages: Arrays, row: int, column: int, fragment: Fragment) -> None:
    """The raster and march stages of the pixel's fragment."""
    march = fragment.march
    pixel = row, column
    stages["raster.face"][pixel] = fragment.face
    stages["raster.patch_id"][pixel] = fragment.patch_id
    stages["raster.patch"][pixel] = fragment.c
    stages["march.linear_index"][pixel] = march.linear_index
    stages["march.hit_index"][pixel] = march.hit_index
    if march.hit is not None:
        stages["march.hit"][pixel] = march.hit
    stages["march.height_before"][pixel] = march.height_before
    stages["march.steep"][pixel] = march.steep
    stages["march.margin"][pixel] = march.margin
    stages["march.domain_margin"][pixel] = march.domain_margin
    stages["march.steep_margin"][pixel] = march.steep_margin


def store_shade(
    stages: Arrays, row: int, column: int, fragment: Fragment, patch: Patch, camera: Camera, light: Light, params: Any
) -> Vec3:
    """4. shade: the shade stage of the pixel's kept fragment; gives its colour."""
    assert fragment.march.hit is not None
    shade = shade_hit(fragment.march.hit, fragment.march.steep, patch, camera, light, params)
    pixel = row, column
    stages["shade.albedo"][pixel] = shade.albedo
    stages["shade.normal"][pixel] = shade.normal
    stages["shade.lit"][pixel] = shade.lit
    stages["shade.lit_margin"][pixel] = shade.lit_margin
    stages["shade.axis_margin"][pixel] = shade.axis_margin
    stages["shade.facing_margin"][pixel] = shade.facing_margin
    return shade.color


# --- Render ----------------------------------------------------------------------------------------------------------


@dataclass
class Params:
    """See displacement/method.md, "Inputs"."""

    method: str
    interval: str
    faces: str
    depth: str
    linear_steps: int
    binary_steps: int
    steep_threshold: float
    shadow_steps: int
    shadow_bias: float


def plain_params(params: Any) -> Params:
    """The parameters as plain Python numbers."""
    return Params(
        method=str(params.method),
        interval=str(params.interval),
        faces=str(params.faces),
        depth=str(params.depth),
        linear_steps=int(params.linear_steps),
        binary_steps=int(params.binary_steps),
        steep_threshold=float(params.steep_threshold),
        shadow_steps=int(params.shadow_steps),
        shadow_bias=float(params.shadow_bias),
    )


def render(scene: Any, params: Any) -> tuple[Arrays, np.ndarray, np.ndarray]:
    """(stages, color, depth) of a frame."""
    params = plain_params(params)
    if params.method not in ("protruded", "relief", "texture"):
        raise ValueError(f"method: {params.method!r} is not one of 'protruded', 'relief', 'texture'")
    camera = Camera(scene.camera)
    light = Light(scene.light)
    patches = [Patch(polygon, camera.eye, light.homogeneous) for polygon in scene.polygons]

    clips: list[Vec4] = []
    corners: list[Vec3] = []
    pixels: dict[tuple[int, int], list[Fragment]] = {}
    for patch_id, patch in enumerate(patches):
        for face, quad in faces_to_draw(patch, params):
            quad_clips = [camera.clip_position(patch.to_world(corner)) for corner in quad]
            clips.extend(quad_clips)
            corners.extend(quad)
            for column, row, fragment in face_fragments(patch, patch_id, face, quad, quad_clips, camera, params):
                pixels.setdefault((row, column), []).append(fragment)

    stages: Arrays = {
        "vertex.clip": np.array(clips, dtype=np.float64).reshape(-1, 4),
        "vertex.patch": np.array(corners, dtype=np.float64).reshape(-1, 3),
        **empty_stages(camera.height, camera.width),
    }
    color = np.empty((camera.height, camera.width, 3))
    color[:, :] = vec3(scene.background)
    depth = np.ones((camera.height, camera.width))
    for (row, column), fragments in pixels.items():
        shown = shown_fragment(fragments)
        fragment = fragments[0] if shown is None else shown
        store_fragment(stages, row, column, fragment)
        stages["resolve.margin"][row, column] = resolve_margin(shown, fragments)
        if fragment.march.hit is not None:
            patch = patches[fragment.patch_id]
            fragment_color = store_shade(stages, row, column, fragment, patch, camera, light, params)
            if shown is not None:
                color[row, column] = fragment_color
                depth[row, column] = shown.depth
    return stages, color, depth
