"""Scenes, parameters and prepared maps of shadows by image warping in `case.json`."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from pydantic import Field

from ibr_ref import shadows
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.schema.base import (
    ArrayFile,
    Inputs,
    Matrix2x3,
    Matrix4,
    Model,
    Stored,
    Vector2,
    Vector3,
    numbers,
    values,
)
from ibr_ref.oracle.schema.camera import CameraFile, build_camera, describe_camera
from ibr_ref.oracle.schema.document import Document, Schema
from ibr_ref.scene import AreaLight, Mesh, checks
from ibr_ref.shadows import parallel
from ibr_ref.shadows.light_map import map_of
from ibr_ref.shadows.percentage_closer import on_map
from ibr_ref.shadows.prepared import depths_of
from ibr_ref.shadows.render import check_maps
from ibr_ref.shadows.samples import samples_of, seen_offset


class ShadowsParams(Model):
    """Maps, warps and light samples."""

    map_size: int
    """S, texels a side."""
    rows: int
    """R, control points downwards."""
    columns: int
    """C, control points across."""
    content: Literal["mask", "depth"]
    map_samples: int
    """k: a mask's texel is the coverage of k x k samples."""
    quantize: Literal[8] | None
    """8: both sides of a comparison of depths are rounded to 8 bits."""
    pcf: bool
    """Four comparisons of depths, mixed bilinearly."""
    bias: float
    """Of depths, in units of window depth."""
    policy: Literal["dissolve", "nearest"]
    interpolation: Literal["linear", "projective"]
    """Pace between two maps: even, or by the caster's depths, `scene.maps.depths`."""
    light_samples: Literal[1, 5, 9] | tuple[Vector3, ...]
    """1, 5 or 9, or world positions; `scene.light_samples` lists them all."""
    accumulation: Literal["float", "unorm8"]
    method: Literal["warp", "direct", "grid", "pcss"]
    grid_size: int = 32
    """n: method = "grid" has n x n maps, from end to end of the widened range."""
    grid_mix: bool = True
    """The mix of the four maps around; otherwise the nearest one."""
    search_points: int = 32
    """method = "pcss": points of the light by which blockers are searched, `scene.soft.search`."""
    filter_points: int = 64
    """method = "pcss": points of the light by which distances are compared, `scene.soft.filter`."""


class MeshFile(Model):
    """Indexed triangles."""

    vertices: ArrayFile
    triangles: ArrayFile
    color: Vector3 | ArrayFile
    """Linear: of the whole mesh, or (V, 3) of its vertices."""


class AreaLightFile(Model):
    """A light that sees what it lights through a square frustum."""

    position: Vector3
    """The centre."""
    target: Vector3
    up: Vector3
    vertical_fov: float
    """Degrees, both ways."""
    near: float
    far: float
    half_edges: Matrix2x3
    """a and b: the light is the parallelogram position +- a +- b."""
    camera: CameraFile
    """Of the maps, from the centre."""


class LightSampleFile(Model):
    """One sample of the light, in the order of accumulation."""

    position: Vector3
    displacement: Vector2
    """position - centre, along the offset axes."""
    seen_offset: Vector2
    """offset - displacement: where the object stands as the sample sees it; the warp is to this place."""
    camera: CameraFile
    """It looks from the sample in the centre's directions; project.* uses its matrices."""


class MapsFile(Model):
    """The nine maps and their control points."""

    positions: ArrayFile
    texels: ArrayFile
    controls: ArrayFile
    content: Literal["mask", "depth"]
    samples: int
    """k."""
    source: str = Field(pattern="^[0-9a-f]{64}$")
    """The reference's digest of caster, axes and light."""
    depths: ArrayFile | None = None
    """interpolation = "projective": of the middle of the caster's box along the light's view axis, [j, i] as the maps."""


class SoftFile(Model):
    """The one map of method = "pcss", and where it is asked."""

    view_from_world: Matrix4
    """Of the map; the third row times (x, y, z, 1) is minus the distance from the light's plane."""
    clip_from_view: Matrix4
    """z in [0, 1]; w is the distance."""
    near: float
    """n, the distance of the map's near plane."""
    far: float
    """f."""
    nearest: float
    """m, the caster's nearest distance."""
    search: ArrayFile
    filter: ArrayFile


class ShadowsScene(Model):
    """Receivers and a caster that moves along two axes; drawn are the receivers in order, then the caster."""

    camera: CameraFile
    light: AreaLightFile
    light_samples: tuple[LightSampleFile, ...] = Field(min_length=1)
    receivers: tuple[MeshFile, ...] = Field(min_length=1)
    caster: MeshFile
    """Its vertices stand at v + x a + y b for the offset (x, y)."""
    offset: Vector2
    offset_axes: Matrix2x3
    """a and b."""
    offset_range: tuple[Vector2, Vector2]
    """(x0, x1), (y0, y1)."""
    ambient: float = Field(ge=0.0, le=1.0)
    """Share of the light that reaches shadows."""
    background: Vector3
    maps: MapsFile | None
    """None: method is not "warp", and the maps are rendered."""
    soft: SoftFile | None = None
    """None: method is not "pcss"."""


class ShadowsCase(Document):
    """Shadows by image warping (Kang & Ihm 2002)."""

    method: Literal["shadows"]
    params: ShadowsParams
    scene: ShadowsScene


def _describe(case: Case, inputs: Inputs) -> tuple[ShadowsParams, ShadowsScene]:
    return _params(case.params), _scene(case.scene, case.params, case.inputs.get("maps"), inputs)


def _params(params: shadows.Params) -> ShadowsParams:
    chosen = values(ShadowsParams, params)
    if isinstance(params.light_samples, np.ndarray):
        chosen["light_samples"] = numbers(params.light_samples)
    return ShadowsParams(**chosen)


def _scene(scene: shadows.Scene, params: shadows.Params, maps: Any, inputs: Inputs) -> ShadowsScene:
    samples = []
    for sample in samples_of(scene, params):
        camera = scene.light.camera(params.map_size, sample.position)
        samples.append(
            LightSampleFile(
                position=numbers(sample.position),
                displacement=numbers(sample.displacement),
                seen_offset=numbers(seen_offset(scene, sample)),
                camera=describe_camera(camera),
            )
        )
    return ShadowsScene(
        camera=describe_camera(scene.camera),
        light=_light(scene.light, params.map_size),
        light_samples=tuple(samples),
        receivers=tuple(_mesh(f"receiver{i}", mesh, inputs) for i, mesh in enumerate(scene.receivers)),
        caster=_mesh("caster", scene.caster, inputs),
        offset=numbers(scene.offset),
        offset_axes=numbers(scene.offset_axes),
        offset_range=numbers(scene.offset_range),
        ambient=scene.ambient,
        background=numbers(scene.background),
        maps=_maps(scene, params, maps, inputs),
        soft=_soft(scene, params, inputs) if params.method == "pcss" else None,
    )


def _soft(scene: shadows.Scene, params: shadows.Params, inputs: Inputs) -> SoftFile:
    frame, window = map_of(scene)
    (near, far), meaning = parallel.planes(window), "(N, 2) points of the light seen at distance 1, in units of the map"
    search, points = (on_map(frame, window, count) for count in (params.search_points, params.filter_points))
    return SoftFile(
        view_from_world=numbers(frame.view_from_world),
        clip_from_view=numbers(parallel.clip_from_view(window)),
        near=near,
        far=far,
        nearest=window.near,
        search=inputs.array("soft.search", search, meaning),
        filter=inputs.array("soft.filter", points, meaning),
    )


def _light(light: AreaLight, map_size: int) -> AreaLightFile:
    return AreaLightFile(
        position=numbers(light.position),
        target=numbers(light.target),
        up=numbers(light.up),
        vertical_fov=light.vertical_fov,
        near=light.near,
        far=light.far,
        half_edges=numbers(light.half_edges),
        camera=describe_camera(light.camera(map_size)),
    )


def _mesh(stem: str, mesh: Mesh, inputs: Inputs) -> MeshFile:
    color = np.asarray(mesh.color)
    return MeshFile(
        vertices=inputs.array(f"{stem}.vertices", np.asarray(mesh.vertices), "(V, 3) positions"),
        triangles=inputs.array(f"{stem}.triangles", np.asarray(mesh.triangles), "(T, 3) indices of vertices"),
        color=numbers(color)
        if color.ndim == 1
        else inputs.array(f"{stem}.color", color, "(V, 3) linear colours; varyings"),
    )


def _maps(scene: shadows.Scene, params: shadows.Params, maps: Any, inputs: Inputs) -> MapsFile | None:
    if params.method != "warp":
        if maps is not None:
            raise checks.reject('inputs["maps"]', type(maps).__name__, f"none with method={params.method!r}")
        return None
    if not isinstance(maps, shadows.Maps):
        raise checks.reject(
            'inputs["maps"]', type(maps).__name__, 'shadows.Maps, of shadows.prepare, with method="warp"'
        )
    texels = "counts of covered samples, 0 to k^2: coverage is count / k^2"
    controls = "[j, i, row, column] = (u, v) in [0, 1]^2 of map [j, i]"
    depths = depths_of(scene, params, maps.positions)
    meaning = "[j, i] = depth of the middle of the caster's box along the light's view axis in map [j, i]"
    content: Literal["mask", "depth"] = "mask" if maps.content == "mask" else "depth"
    return MapsFile(
        positions=inputs.array(
            "maps.positions", maps.positions, "[j, i] = offset (x_i, y_j) of the caster in map [j, i]"
        ),
        texels=inputs.array("maps.texels", maps.texels, texels if content == "mask" else "window depth; 1 where empty"),
        controls=inputs.array("maps.controls", maps.controls, controls),
        content=content,
        samples=maps.samples,
        source=maps.source,
        depths=None if depths is None else inputs.array("maps.depths", depths, meaning),
    )


def _build(document: ShadowsCase, stored: Stored) -> tuple[shadows.Scene, shadows.Params, dict[str, Any]]:
    scene, maps = _built_scene(document.scene, stored)
    params = shadows.Params(**document.params.model_dump())
    if params.method == "warp":
        check_maps(scene, params, maps)
    return scene, params, {} if maps is None else {"maps": maps}


def _built_scene(file: ShadowsScene, stored: Stored) -> tuple[shadows.Scene, shadows.Maps | None]:
    light = file.light.model_dump(exclude={"camera"})
    scene = shadows.Scene(
        receivers=[_built_mesh(mesh, stored) for mesh in file.receivers],
        caster=_built_mesh(file.caster, stored),
        light=AreaLight(**light),
        camera=build_camera(file.camera),
        offset=file.offset,
        offset_axes=file.offset_axes,
        offset_range=file.offset_range,
        ambient=file.ambient,
        background=file.background,
    )
    if file.maps is None:
        return scene, None
    maps = shadows.Maps(
        positions=stored[file.maps.positions.file],
        texels=stored[file.maps.texels.file],
        controls=stored[file.maps.controls.file],
        content=file.maps.content,
        samples=file.maps.samples,
        source=file.maps.source,
    )
    return scene, maps


def _built_mesh(file: MeshFile, stored: Stored) -> Mesh:
    color = stored[file.color.file] if isinstance(file.color, ArrayFile) else file.color
    return Mesh(vertices=stored[file.vertices.file], triangles=stored[file.triangles.file], color=color)


def _features(document: ShadowsCase) -> set[str]:
    params = document.params
    found: set[str] = {params.method, params.content, params.accumulation}
    if params.method == "warp":
        found.add(params.policy)
    if params.content == "depth":
        found |= {word for word, used in (("pcf", params.pcf), ("quantize", params.quantize is not None)) if used}
    return found


SCHEMA = Schema(document=ShadowsCase, describe=_describe, build=_build, features=_features)
