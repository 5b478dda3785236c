"""What occurs in a frame: counted over many, it shows what a test of agreement has covered.

Names starting with "in:" are read off the scene and its parameters, those with "out:" off the frame.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement import Params, Scene
from ibr_ref.io import Frame
from ibr_ref.scene import BasePolygon, Camera
from tests.naive import patch as naive
from tests.naive import raster

Stages = dict[str, NDArray[np.generic]]


def features(scene: Scene, params: Params, frame: Frame) -> set[str]:
    """The names of all features of a frame with its stages."""
    patches = [naive_patch(scene, polygon) for polygon in scene.polygons]
    given = itertools.chain(
        of_params(params),
        of_camera(scene.camera),
        of_light(scene),
        *(of_polygon(polygon) for polygon in scene.polygons),
        *(of_eye(patch) for patch in patches),
        *(of_patch_light(patch) for patch in patches),
        ["several polygons"] if len(patches) > 1 else [],
    )
    found = itertools.chain(of_vertices(scene.camera, frame), of_outcome(params, frame), of_hidden(frame))
    return {f"in: {name}" for name in given} | {f"out: {name}" for name in found}


def naive_patch(scene: Scene, polygon: BasePolygon) -> naive.Patch:
    """The polygon with the eye and the light in its patch space."""
    return naive.Patch(polygon, naive.Camera(scene.camera).eye, naive.Light(scene.light).homogeneous)


# --- What is given ---------------------------------------------------------------------------------------------------


def of_params(params: Params) -> Iterator[str]:
    """Every choice; the ends of the numbers' ranges."""
    yield f"method {params.method}"
    if params.method == "protruded":
        yield f"faces {params.faces}"
        yield f"interval {params.interval}"
    yield f"depth {params.depth}"
    yield f"binary steps {params.binary_steps}"
    yield "one linear step" if params.linear_steps == 1 else "linear steps"
    if params.shadow_steps:
        yield f"self-shadow {params.method}"
    if params.shadow_steps and params.shadow_bias == 0.0:
        yield "no shadow bias"
    if params.steep_threshold <= 0.0:
        yield "threshold not positive"


def of_camera(camera: Camera) -> Iterator[str]:
    """Its kind."""
    clip = camera.clip_from_view
    yield "perspective" if camera.perspective else "orthographic"
    if clip[0, 1] != 0.0:
        yield "sheared pixels"
    if clip[0, 0] < 0.0:
        yield "mirrored picture"


def of_light(scene: Scene) -> Iterator[str]:
    """Its kind and its coefficients."""
    light = scene.light
    yield "directional light" if light.position is None else "point light"
    if light.specular > 0.0:
        yield "specular"
    if light.specular > 0.0 and light.exponent == 0:
        yield "exponent 0"


def of_polygon(polygon: BasePolygon) -> Iterator[str]:
    """Its shape and its maps."""
    _, edge_u, edge_v = polygon.arrays
    heights = np.asarray(polygon.height_map)
    rows, columns = heights.shape
    yield f"domain {polygon.domain}"
    yield f"map {min(rows, 2)}x{min(columns, 2)}".replace("2", "n")
    if max(rows, columns) > 16:
        yield "large map"
    if abs(edge_u @ edge_v) > 0.1 * np.linalg.norm(edge_u) * np.linalg.norm(edge_v):
        yield "sheared polygon"
    if np.count_nonzero(np.cross(edge_u, edge_v)) > 1:
        yield "tilted polygon"
    for height in (0.0, 1.0):
        if (heights == height).any():
            yield f"height exactly {height:g}"
    if heights.size > 3 and np.count_nonzero(heights) == 1:
        yield "spike of one texel"
    maps = [name for name in ("normal", "facade") if getattr(polygon, f"{name}_map") is not None]
    yield " and ".join(maps) + " map" if maps else "no normal or facade map"


def of_eye(patch: naive.Patch) -> Iterator[str]:
    """Where the eye is as the volume sees it."""
    u, v, h, w = patch.eye
    if w == 0.0:
        yield "direction from above" if h > 0.0 else "direction not from above"
        return
    over = 0.0 <= u <= 1.0 and 0.0 <= v <= 1.0
    if h > 1.0:
        yield "eye above the volume" if over else "eye above and aside"
    elif h > 0.0:
        yield "eye inside the volume" if over else "eye beside the volume"
    else:
        yield "eye below the polygon"
    if h != 1.0 and abs(h - 1.0) < 0.05 and not over:
        yield "eye grazing the top"
    if 0.0 < h < 0.05:
        yield "eye grazing the polygon"
    yield from (f"eye on {name}" for name, x in zip("uvh", (u, v, h), strict=True) if x in (0.0, 1.0))


def of_patch_light(patch: naive.Patch) -> Iterator[str]:
    """Where the light is as the volume sees it."""
    u, v, h, w = patch.light
    if h <= 0.0:
        yield "light below the horizon"
    elif w == 1.0 and max(u, v, h) < 1.0 and min(u, v) > 0.0:
        yield "light inside the volume"


# --- What comes out --------------------------------------------------------------------------------------------------


def of_vertices(camera: Camera, frame: Frame) -> Iterator[str]:
    """What the clipper had to do."""
    clip = frame.stages["vertex.clip"].astype(np.float64)
    if not len(clip):
        yield "no faces"
        return
    quads = clip.reshape(-1, 4, 4)
    distances = {"near plane": quads[..., 2], "far plane": quads[..., 3] - quads[..., 2]}
    for plane, distance in distances.items():
        if ((distance < 0.0).any(axis=1) & (distance > 0.0).any(axis=1)).any():
            yield f"{plane} cuts a face"
    if any(beyond_guard(quad[corners], camera) for quad in quads for corners in ([0, 1, 2], [0, 2, 3])):
        yield "guard band cuts a face"


def beyond_guard(triangle: NDArray[np.float64], camera: Camera) -> bool:
    """Whether the triangle is cut by more than the near and the far plane."""
    polygon = raster.clip_against(triangle.tolist(), lambda p: p[2])
    polygon = raster.clip_against(polygon, lambda p: p[3] - p[2])
    size = camera.width, camera.height
    return any(abs(p[axis]) > 2.0**21 / size[axis] * p[3] for p in polygon for axis in (0, 1))


def of_outcome(params: Params, frame: Frame) -> Iterator[str]:
    """How the pixels ended."""
    stages, shown = frame.stages, frame.depth < 1.0
    kept, linear = stages["march.hit_index"] >= 0, stages["march.linear_index"]
    lattice = params.linear_steps << params.binary_steps
    steep = stages["march.steep"].astype(bool)
    outcomes = {
        "something shown": shown,
        "nothing covers the pixel": stages["raster.face"] < 0,
        "kept but not shown": kept & ~shown,
        "discarded": (stages["raster.face"] >= 0) & ~kept,
        "discarded at the near plane": discarded_at_near(params, stages),
        f"hit {params.method}": shown & (linear > 0),
        "hit at the start of the ray": shown & (linear == 0),
        "hit on the polygon": shown & (linear < 0) & (stages["march.hit_index"] == lattice),
        "hit at the last lattice point": shown & (linear >= 0) & (stages["march.hit_index"] == lattice),
        "steep": steep,
        "facade": np.isfinite(stages["shade.axis_margin"].astype(float)),
        "steep without facade": steep & ~np.isfinite(stages["shade.axis_margin"].astype(float)),
        "in shadow": kept & ~stages["shade.lit"].astype(bool) & np.isfinite(stages["shade.lit_margin"].astype(float)),
    }
    names = ("march.margin", "march.domain_margin", "march.steep_margin", "shade.lit_margin", "shade.axis_margin")
    outcomes |= {f"tie of {name}": stages[name] == 0.0 for name in (*names, "resolve.margin")}
    c = stages["raster.patch"].astype(float)
    outcomes["fragment on the border"] = (c[..., 2] == 0.0) & ((c[..., :2] == 0.0) | (c[..., :2] == 1.0)).any(axis=-1)
    yield from (name for name, pixels in outcomes.items() if pixels.any())
    yield from (f"face {face}" for face in np.unique(stages["raster.face"][shown]))


def discarded_at_near(params: Params, stages: Stages) -> NDArray[np.bool_]:
    """Fragments over the polygon always hit something: one that does not lay in front of the near plane."""
    c = stages["raster.patch"].astype(float)
    over = (c[..., 2] == 0.0) & ((c[..., :2] >= 0.0) & (c[..., :2] <= 1.0)).all(axis=-1)
    missed = (stages["march.hit_index"] < 0) & (params.method == "protruded")
    return over & missed & (stages["march.domain_margin"] < math.inf)


def of_hidden(frame: Frame) -> Iterator[str]:
    """Fragments behind what is shown."""
    patch_ids = frame.stages["raster.patch_id"][frame.depth < 1.0]
    if len(np.unique(patch_ids)) > 1:
        yield "several polygons shown"
    if np.isfinite(frame.stages["resolve.margin"].astype(float)).any():
        yield "hidden fragments"
