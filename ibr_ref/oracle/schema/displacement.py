"""Scenes and parameters of protruded displacement mapping in `case.json`."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from ibr_ref import displacement
from ibr_ref.displacement.patch_space import uniforms
from ibr_ref.displacement.port_maps import RELAXED, cone_map_of, distance_map_of, levels_of
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.schema.base import (
    ArrayFile,
    Inputs,
    Matrix3,
    Model,
    Stored,
    Vector2,
    Vector3,
    Vector4,
    numbers,
    texels,
    values,
)
from ibr_ref.oracle.schema.camera import CameraFile, build_camera, describe_camera
from ibr_ref.oracle.schema.document import Document, Schema
from ibr_ref.oracle.schema.light import LightFile, build_light, describe_light
from ibr_ref.scene import BasePolygon
from ibr_ref.scene.checks import reject
from ibr_ref.searches import SEARCHES

LEVEL = "0 in a case of mcguire: drivers make coarser levels in their own ways"
"""Of the height map."""


class DisplacementParams(Model):
    """Parameters of the search, named as in the paper's sections 3 and 4."""

    linear_steps: int
    """N, samples of the linear search."""
    binary_steps: int
    """M, halvings of the binary search."""
    steep_threshold: float
    """delta: a hit is on a wall if h - a > delta, a the height map one linear step before."""
    interval: Literal["paper", "volume"]
    """From the top of the volume to the polygon's plane, or the ray's own stretch inside the volume."""
    faces: Literal["auxiliary", "base", "extended"]
    """Base and side faces that are turned away from the eye; the base alone; the base enlarged."""
    depth: Literal["displaced", "polygon"]
    """Window depth of the hit, or of the face."""
    shadow_steps: int
    """S, samples towards the light; 0: no self-shadow."""
    shadow_bias: float
    """In units of h."""
    method: Literal[
        "protruded", "relief", "welsh", "mcguire", "tatarchuk", "cone", "relaxed_cone", "donnelly", "maximum_mipmap"
    ]
    """The search."""
    lod_bias: float = 1.0
    """Level of the mip chain that "mcguire" takes heights from: 0."""
    min_steps: int = 8
    """Steps of "tatarchuk" where the view is straight down."""
    max_steps: int = 50
    """Steps of "tatarchuk" where it is horizontal."""
    distance_layers: int = 32
    """Of the `distance_map` of "donnelly"."""


class PatchSpace(Model):
    """Constants of the polygon's draw call, as the reference computes them."""

    axes: Matrix3
    """Rows U, V and height_scale n: world = corner + u U + v V + h (height_scale n)."""
    rows: Matrix3
    """Reciprocal basis: (u, v, h) = rows (world - corner)."""
    frame: Matrix3
    """Tangent frame of the normal map: x = U/|U|, y = n x x, z = n."""
    eye: Vector4
    """The eye in patch space, homogeneous: the way from p towards it is xyz - w p."""
    light: Vector4


class PolygonFile(Model):
    """A base polygon, the bottom of the displaced volume; patch_id of the stages is its index in the scene."""

    corner: Vector3
    edge_u: Vector3
    edge_v: Vector3
    height_scale: float
    """World units of height 1, along normalize(edge_u x edge_v)."""
    domain: Literal["clip", "repeat"]
    """Wrap mode of all its maps but the facade's; "clip": the map ends at its border, and fetches clamp."""
    facade_tile: Vector2
    """Width and height of one facade tile, world units."""
    height_map: ArrayFile
    color_map: ArrayFile
    normal_map: ArrayFile | None
    """None: normals come from the heights, by central differences."""
    facade_map: ArrayFile | None
    """None: walls take the colour map."""
    cone_map: ArrayFile | None = None
    """Of searches by cones alone."""
    distance_map: ArrayFile | None = None
    """Of "donnelly" alone: (layers, rows, columns), a texture of three dimensions; layer 0 is the top."""
    quadtree: tuple[ArrayFile, ...] | None = None
    """Of "maximum_mipmap" alone: the largest height of each cell between four texel centres, then of two by two of them, and
    so on up to a single one."""
    patch_space: PatchSpace


class DisplacementScene(Model):
    """Base polygons, drawn in order."""

    camera: CameraFile
    light: LightFile
    background: Vector3
    polygons: tuple[PolygonFile, ...] = Field(min_length=1)


class DisplacementCase(Document):
    """Protruded displacement mapping (Yoo & Han 2006)."""

    method: Literal["displacement"]
    params: DisplacementParams
    scene: DisplacementScene


MOST_FACES = 64
"""That a port may hand in for a polygon, which has six."""


def _describe(case: Case, inputs: Inputs) -> tuple[DisplacementParams, DisplacementScene]:
    params = DisplacementParams(**values(DisplacementParams, case.params))
    if params.method == "mcguire" and params.lod_bias != 0.0:
        raise reject("lod_bias", params.lod_bias, LEVEL)
    return params, _scene(case.scene, params, inputs)


def _scene(scene: displacement.Scene, params: DisplacementParams, inputs: Inputs) -> DisplacementScene:
    return DisplacementScene(
        camera=describe_camera(scene.camera),
        light=describe_light(scene.light),
        background=numbers(scene.background),
        polygons=tuple(_polygon(scene, i, polygon, params, inputs) for i, polygon in enumerate(scene.polygons)),
    )


def _polygon(
    scene: displacement.Scene, index: int, polygon: BasePolygon, params: DisplacementParams, inputs: Inputs
) -> PolygonFile:
    stem = f"polygon{index}"
    optional = {
        "normal_map": (polygon.normal_map, "n = 2 c - 1 in the tangent frame, normalized after the bilinear fetch"),
        "facade_map": (polygon.facade_map, "the tile that covers steep walls, repeated; linear colour"),
    }
    constants = uniforms(polygon, scene.camera, scene.light)
    domain: Literal["clip", "repeat"] = "repeat" if polygon.domain == "repeat" else "clip"
    return PolygonFile(
        corner=numbers(polygon.corner),
        edge_u=numbers(polygon.edge_u),
        edge_v=numbers(polygon.edge_v),
        height_scale=polygon.height_scale,
        domain=domain,
        facade_tile=polygon.facade_tile,
        height_map=inputs.texture(f"{stem}.height_map", polygon.height_map, "height h in [0, 1]; row 0 is v = 0"),
        color_map=inputs.texture(f"{stem}.color_map", polygon.color_map, "linear colour; row 0 is v = 0"),
        **{
            name: None if map_ is None else inputs.texture(f"{stem}.{name}", map_, meaning)
            for name, (map_, meaning) in optional.items()
        },
        cone_map=_cones(f"{stem}.cone_map", polygon, params.method, inputs),
        distance_map=_distances(f"{stem}.distance_map", polygon, params, inputs),
        quadtree=_quadtree(f"{stem}.quadtree", polygon, params.method, inputs),
        patch_space=PatchSpace(
            axes=numbers(constants.axes),
            rows=numbers(constants.rows),
            frame=numbers(constants.frame),
            eye=numbers(constants.eye),
            light=numbers(constants.light),
        ),
    )


def _cones(stem: str, polygon: BasePolygon, method: str, inputs: Inputs) -> ArrayFile | None:
    if method not in RELAXED:
        return None
    meaning = "radius in (u, v) per height of the cone over each texel; filtered as the height map is"
    return inputs.array(stem, cone_map_of(polygon, method), meaning)


def _distances(stem: str, polygon: BasePolygon, params: DisplacementParams, inputs: Inputs) -> ArrayFile | None:
    if params.method != "donnelly":
        return None
    meaning = "distance to the nearest solid voxel in (u, v, d); trilinear, wrapped as the height map is, clamped in d"
    return inputs.array(stem, distance_map_of(polygon, params.distance_layers), meaning)


def _quadtree(stem: str, polygon: BasePolygon, method: str, inputs: Inputs) -> tuple[ArrayFile, ...] | None:
    if method != "maximum_mipmap":
        return None
    meaning = "the largest height of each node"
    return tuple(inputs.array(f"{stem}{i}", level, meaning) for i, level in enumerate(levels_of(polygon)))


def _build(
    document: DisplacementCase, stored: Stored
) -> tuple[displacement.Scene, displacement.Params, dict[str, Any]]:
    file = document.scene
    scene = displacement.Scene(
        camera=build_camera(file.camera),
        light=build_light(file.light),
        background=file.background,
        polygons=[_built_polygon(polygon, stored) for polygon in file.polygons],
    )
    return scene, displacement.Params(**document.params.model_dump()), {}


def _built_polygon(file: PolygonFile, stored: Stored) -> BasePolygon:
    maps: Any = {}
    for name in ("height_map", "color_map", "normal_map", "facade_map"):
        map_: ArrayFile | None = getattr(file, name)
        maps[name] = None if map_ is None else texels(stored, map_)
    return BasePolygon(
        corner=file.corner,
        edge_u=file.edge_u,
        edge_v=file.edge_v,
        height_scale=file.height_scale,
        domain=file.domain,
        facade_tile=file.facade_tile,
        **maps,
    )


def _features(document: DisplacementCase) -> set[str]:
    params, scene = document.params, document.scene
    search = SEARCHES[params.method]
    found = {
        "phong",
        params.method,
        "shadow" if params.shadow_steps else "unshadowed",
        "displaced" if params.depth == "displaced" and search.displaces else "polygon_depth",
    }
    found |= {params.interval, params.faces} if "faces" in search.reads else {"sunken", "base"}
    for polygon in scene.polygons:
        found.add("heights" if polygon.normal_map is None else "normal_map")
        if polygon.facade_map is not None and "facade_map" in search.reads:
            found.add("facade")
    if found & {"heights", "facade"}:
        found.add("gradient")
    return found


def _most_faces(scene: displacement.Scene) -> dict[str, int]:
    return dict.fromkeys(("vertex.clip", "vertex.patch"), MOST_FACES * len(scene.polygons))


SCHEMA = Schema(document=DisplacementCase, describe=_describe, build=_build, features=_features, most_faces=_most_faces)
