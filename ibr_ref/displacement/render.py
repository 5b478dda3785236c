"""The passes of protruded displacement mapping, in order."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.array_types import Indices, Ints
from ibr_ref.displacement import compared, inputs
from ibr_ref.displacement.buffers import Settings
from ibr_ref.displacement.contract import FRAGMENT_FIELDS
from ibr_ref.displacement.fragment import BUILT_IN, draw, rows_of_a_band
from ibr_ref.displacement.inputs import Params, Scene
from ibr_ref.displacement.maxima import build
from ibr_ref.displacement.patch_space import uniforms
from ibr_ref.displacement.prepared import prepared
from ibr_ref.displacement.raster import cover
from ibr_ref.displacement.resolve import Target, resolve_margins, target_for
from ibr_ref.displacement.textures import Map, Maps
from ibr_ref.displacement.vertex import Faces, vertex_stage
from ibr_ref.io import Frame
from ibr_ref.pipeline.clip import clip_triangles
from ibr_ref.pipeline.triangles import set_up, shifted
from ibr_ref.scene import BasePolygon, checks
from ibr_ref.searches import SEARCHES


def render(
    scene: Scene, params: Params | None = None, *, stages: bool = True, rows: tuple[int, int] | None = None
) -> Frame:
    """Render base polygons with their height maps.

    With `stages` the frame holds every intermediate array (`contract.STAGES` lists them); without, the same
    picture and depth sooner. rows: first and one past the last row of the picture that are drawn, the same bits as in all
    of it; None: all. Raises ValueError for inputs that only together are not allowed.
    """
    params = Params() if params is None else params
    inputs.check(scene, params)
    camera = scene.camera
    constants = [uniforms(polygon, camera, scene.light) for polygon in scene.polygons]
    for polygon_constants in constants:
        inputs.check_eye(params, polygon_constants.eye)
    faces = [vertex_stage(c, params.drawn_faces, params.interval) for c in constants]
    first, stop = checks.rows(rows, camera.height)
    target = target_for(camera.width * (stop - first), stages)
    background = np.array(scene.background, np.float64)
    band_rows = rows_of_a_band(camera.width)
    fetches: list[Indices] = []
    for patch_id, (polygon, quads) in enumerate(zip(scene.polygons, faces, strict=True)):
        clipped = clip_triangles(quads.clip, quads.patch, quads.triangles, camera.width, camera.height)
        triangles = shifted(set_up(clipped, camera.width, camera.height), first, stop)
        repeat = True if polygon.domain == "repeat" else None
        keep = True if stages else None
        settings = _settings(params, polygon)
        maps, room = _maps(polygon), SEARCHES[params.method].room
        fragments = bands = hits = None
        if room is not None:
            fragments, bands = cover(
                triangles, quads.numbers, camera.width, stop - first, band_rows, settings.polygon_depth
            )
            hits, counts = compared.search(room, params, polygon, maps.height, constants[patch_id], fragments)
            if stages:
                fetches.append(_by_pixel(fragments.pixel, counts, camera.width * (stop - first)))
        draw(
            repeat, keep, fragments, bands, hits, triangles, quads.numbers, constants[patch_id], settings, *maps, patch_id,
            camera.width, stop - first, band_rows, background, target,
        )  # fmt: skip
    size = (stop - first, camera.width)
    return Frame(
        color=target.color.reshape(*size, 3),
        depth=target.depth.reshape(size),
        stages=_stages(faces, target, size, fetches) if stages else {},
    )


def _by_pixel(pixel: Ints, counts: Indices, pixels: int) -> Indices:
    """Fetches of a polygon's fragments, which cover no pixel twice, as a picture, flat."""
    fetches = np.zeros(pixels, np.int32)
    fetches[pixel[pixel >= 0]] = counts[pixel >= 0]
    return fetches


def _settings(params: Params, polygon: BasePolygon) -> Settings:
    volume = params.interval == "volume" and params.drawn_faces == "auxiliary"
    search = SEARCHES[params.method]
    return Settings(
        method=BUILT_IN.index(params.method) if params.method in BUILT_IN else -1,
        volume=volume,
        bounded=polygon.domain == "clip" and not volume,
        linear_steps=params.linear_steps,
        binary_steps=params.binary_steps,
        steep_threshold=params.steep_threshold,
        shadow_steps=params.shadow_steps,
        shadow_bias=params.shadow_bias,
        floor=-1.0 if search.sinks else 0.0,
        polygon_depth=params.depth == "polygon" or not search.displaces,
    )


def _map(texels: ArrayLike | None) -> Map:
    if texels is None:
        array = np.empty(0)
        array.setflags(write=False)  # as the others: a writable array would be another compilation
        return Map(array, 0.0, 0.0)
    image = np.asarray(texels, np.float64)
    return Map(image.reshape(-1), float(image.shape[1]), float(image.shape[0]))


def _maps(polygon: BasePolygon) -> Maps:
    height = _map(polygon.height_map)
    return Maps(
        height=height,
        color=_map(polygon.color_map),
        normal=_map(polygon.normal_map),
        facade=_map(polygon.facade_map),
        maxima=prepared(polygon, ("maxima",), lambda: build(height.texels, int(height.rows), int(height.columns))),
    )


def _stages(
    faces: list[Faces], target: Target, size: tuple[int, int], fetches: list[Indices]
) -> dict[str, NDArray[np.generic]]:
    """The stage arrays by their names in the contract. fetches: of the compared systems, for each polygon."""
    resolve_margins(target, target.second)
    stages: dict[str, NDArray[np.generic]] = {
        "vertex.clip": np.concatenate([f.clip for f in faces]),
        "vertex.patch": np.concatenate([f.patch for f in faces]),
    }
    for field, name in FRAGMENT_FIELDS.items():
        array = getattr(target, field)
        stages[name] = array.reshape(*size, *array.shape[1:])
    if fetches:
        shown = np.maximum(target.patch_id, 0)[None]
        stages["march.fetches"] = np.take_along_axis(np.array(fetches), shown, axis=0).reshape(size)
    stages["resolve.margin"] = target.second.reshape(size)
    return stages
