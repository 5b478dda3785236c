"""The passes of shadows by image warping, in order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.io import Frame
from ibr_ref.scene import AreaLight, checks
from ibr_ref.shadows import grid
from ibr_ref.shadows.ensemble import Ensemble
from ibr_ref.shadows.grid import MapGrid
from ibr_ref.shadows.inputs import Params, Scene
from ibr_ref.shadows.light_map import depth_map, softened
from ibr_ref.shadows.maps import values
from ibr_ref.shadows.percentage_closer import Softened
from ibr_ref.shadows.prepared import Maps, check_unfolded, depths_of, prepare, source_of, texels_at, view_of
from ibr_ref.shadows.project import DEPTH, DEPTH_PCF, MASK, Lookup, Projected, project
from ibr_ref.shadows.resolve import accumulate, one_light, resolve
from ibr_ref.shadows.samples import Sample, samples_of, seen_offset
from ibr_ref.shadows.surface import Object, Surface, see
from ibr_ref.shadows.vertex import place
from ibr_ref.shadows.warp import Warped, grids_at, locate, shares_at, warp_stage

Projects = Callable[[Sample, Floats, Surface], Projected | Softened]
"""A sample's map (S, S) onto what is seen."""


def render(
    scene: Scene,
    params: Params | None = None,
    *,
    maps: Maps | MapGrid | None = None,
    stages: bool = True,
    rows: tuple[int, int] | None = None,
) -> Frame:
    """Draw receivers and caster with the caster's shadow.

    maps: what `prepare` made for this scene's caster, axes and light, for any offset (for method="grid" `prepare_grid`);
    None: made here, at every call. With `stages` the frame holds every intermediate array (`contract.STAGES` lists
    them); without, the same picture and depth sooner. rows: first and one past the last row of the picture that are drawn,
    the same bits as in all of it; None: all. Raises ValueError for inputs that only together are not allowed, and for maps
    that do not fit the scene and the parameters.
    """
    params = Params() if params is None else params
    samples = samples_of(scene, params)
    images, kept = images_of(scene, params, samples, maps, stages)
    surface = surface_of(scene, rows)
    projects = _softener(scene, params) if params.method == "pcss" else _projector(scene, params, stages)
    shadow = np.zeros(surface.depth.shape)
    projections: list[Projected | Softened] = []
    for sample, image in zip(samples, images, strict=True):
        projected = projects(sample, image, surface)
        accumulate(shadow, projected.shadow, len(samples), params.accumulation == "unorm8")
        if stages:
            projections.append(projected)
    np.minimum(shadow, 1.0, out=shadow)  # N times 1/N may come out an ulp above 1
    lights, background = one_light(scene.light.arrays[0]), np.asarray(scene.background)
    color = resolve(surface, shadow[np.newaxis], scene.camera.eye, lights, float(scene.ambient), background)
    if stages:
        kept.update(grouped("project", projections[0]._fields, projections), **{"accumulate.shadow": shadow})
    return Frame(color=color, depth=surface.depth, stages=kept)


def shadow_maps(scene: Scene, params: Params | None = None, *, maps: Maps | MapGrid | None = None) -> Floats:
    """The maps (N, S, S) that `render` projects, one for each light sample; maps as there."""
    params = Params() if params is None else params
    return np.stack(images_of(scene, params, samples_of(scene, params), maps, stages=False)[0])


# --- The maps that are projected -------------------------------------------------------------------------------------


def images_of(
    scene: Scene, params: Params, samples: Sequence[Sample], maps: Maps | MapGrid | None, stages: bool
) -> tuple[list[Floats], dict[str, Any]]:
    """A map (S, S) for each light sample, and the stages up to it."""
    if params.method == "warp":
        return _warped(scene, params, samples, _nine(scene, params, samples, maps), stages)
    if params.method == "grid":
        images = _from_grid(scene, params, samples, maps)
    elif maps is not None:
        raise checks.reject("maps", type(maps).__name__, f'None with method="{params.method}"')
    elif params.method == "pcss":
        images = [depth_map(scene, params)]
    else:
        images = [_direct(scene, params, sample) for sample in samples]
    return images, {"warp.image": per_sample(images)} if stages else {}


def _direct(scene: Scene, params: Params, sample: Sample) -> Floats:
    """The map as it is rendered from the sample, of the caster where it is."""
    view = view_of(scene, params.map_size, sample.position)
    return values(texels_at(view, np.asarray(scene.offset), params), params.map_samples)


def check_maps(scene: Scene, params: Params, maps: object) -> None:
    """Raise ValueError for what are no maps of the scene and the parameters, with method="warp"."""
    if not isinstance(maps, Maps):
        raise checks.reject("maps", type(maps).__name__, "Maps")
    _nine(scene, params, samples_of(scene, params), maps)


def _nine(scene: Scene, params: Params, samples: Sequence[Sample], maps: Maps | MapGrid | None) -> Maps:
    if maps is None:
        return prepare(scene, params)
    if not isinstance(maps, Maps):
        raise checks.reject("maps", type(maps).__name__, 'Maps, or None, with method="warp"')
    _check_made_for(scene, params, maps.made_with, maps.source)
    x, y = maps.lines
    _check_range(scene, samples, np.array([(x[0], y[0]), (x[2], y[2])]))
    return maps


def _check_made_for(scene: Scene, params: Params, given: dict[str, object], source: str) -> None:
    for name, value in given.items():
        if value != getattr(params, name):
            raise checks.reject(f"maps ({name})", value, f"{getattr(params, name)}, as in params")
    if source != source_of(scene):
        raise checks.reject("maps", "those of another caster, other axes or another light", "maps of this scene")


def _check_range(scene: Scene, samples: Sequence[Sample], ends: Floats) -> None:
    for sample in samples:
        offset = seen_offset(scene, sample)
        if not ((ends[0] <= offset) & (offset <= ends[1])).all():
            (x0, y0), (x1, y1) = ends.tolist()
            raise checks.reject(
                "maps",
                f"an object at {tuple(offset.tolist())} as a light sample sees it",
                f"x from {x0:g} to {x1:g} and y from {y0:g} to {y1:g}, where the maps were made",
            )


def _warped(
    scene: Scene, params: Params, samples: Sequence[Sample], maps: Maps, stages: bool
) -> tuple[list[Floats], dict[str, Any]]:
    warps = []
    depths, nearest = depths_of(scene, params, maps.positions), params.policy == "nearest"
    for i, sample in enumerate(samples):
        cell, fraction = locate(maps.positions, seen_offset(scene, sample))
        _check_grids(maps.controls, cell, shares_at(cell, fraction, depths), i)
        warps.append(warp_stage(maps.nine, cell, fraction, depths, nearest))
    images = [w.image for w in warps]
    if not stages:
        return images, {}
    made = {"maps.positions": maps.positions, "maps.image": maps.image, "controls": maps.controls}
    if depths is None:
        return images, {**made, **grouped("warp", [name for name in Warped._fields if name != "shares"], warps)}
    return images, {**made, "maps.depths": depths, **grouped("warp", Warped._fields, warps)}


def _check_grids(controls: Floats, cell: NDArray[np.int32], three: Floats, sample: int) -> None:
    row_grids, between = grids_at(controls, cell, three)
    for name, points in (("row_grids[0]", row_grids[0]), ("row_grids[1]", row_grids[1]), ("grid", between)):
        check_unfolded(f"controls (warp.{name} of light sample {sample})", points)


def _from_grid(scene: Scene, params: Params, samples: Sequence[Sample], maps: Maps | MapGrid | None) -> list[Floats]:
    lookup, ends = grid.rendered(scene, params), grid.ends_of(scene, params)
    if maps is not None:
        if not isinstance(maps, MapGrid):
            raise checks.reject("maps", type(maps).__name__, 'MapGrid, or None, with method="grid"')
        given = {
            "map_size": maps.size,
            "content": maps.content,
            "map_samples": maps.samples,
            "grid_size": maps.count,
            "grid_storage": maps.storage,
        }
        _check_made_for(scene, params, given, maps.source)
        _check_range(scene, samples, maps.ends)
        lookup, ends = maps.image, maps.ends
    offsets = [seen_offset(scene, sample) for sample in samples]
    return [grid.image_at(lookup, ends, params.grid_size, offset, params.grid_mix) for offset in offsets]


# --- What they are projected onto ------------------------------------------------------------------------------------


def caster_from(scene: Scene | Ensemble) -> int:
    """Index of the casters' first triangle on the surface."""
    return sum(len(np.asarray(mesh.triangles)) for mesh in scene.receivers)


def surface_of(scene: Scene | Ensemble, rows: tuple[int, int] | None = None) -> Surface:
    """What the scene's camera sees, every caster at its offset; rows as in `render`."""
    objects = [
        Object(np.asarray(mesh.vertices), np.asarray(mesh.triangles), np.asarray(mesh.color))
        for mesh in scene.receivers
    ]
    objects += [
        Object(place(np.asarray(mesh.vertices), axes, offset), np.asarray(mesh.triangles), np.asarray(mesh.color))
        for mesh, axes, offset in scene.movers
    ]
    camera = scene.camera
    size = camera.width, camera.height
    return see(objects, camera.view_from_world, camera.clip_from_view, *size, checks.rows(rows, camera.height))


def lookup_of(scene: Scene | Ensemble, params: Params, keep: bool) -> Lookup:
    """How maps are read."""
    mode = MASK if params.content == "mask" else DEPTH_PCF if params.pcf else DEPTH
    return Lookup(mode, params.quantize is not None, float(params.bias), caster_from(scene), keep)


def _projector(scene: Scene, params: Params, keep: bool) -> Projects:
    lookup = lookup_of(scene, params, keep)
    return lambda sample, image, surface: projected_from(scene.light, sample, image, surface, lookup)


def _softener(scene: Scene, params: Params) -> Projects:
    first = caster_from(scene)
    return lambda _, image, surface: softened(scene, params, first, image, surface)


def projected_from(light: AreaLight, sample: Sample, image: Floats, surface: Surface, lookup: Lookup) -> Projected:
    """A map (S, S) from a sample of a light onto what is seen."""
    camera = light.camera(len(image), sample.position)
    return project(surface.triangle, surface.varyings, camera.view_from_world, camera.clip_from_view, image, lookup)


# --- Stages ----------------------------------------------------------------------------------------------------------


def per_sample(arrays: Sequence[NDArray[np.generic]]) -> NDArray[np.generic]:
    """Along a leading axis of samples, which a single one does not have."""
    return np.stack(arrays) if len(arrays) > 1 else arrays[0]


def grouped(group: str, names: Sequence[str], results: Sequence[Any]) -> dict[str, Any]:
    """Stages "group.name" of the results of all samples."""
    return {f"{group}.{name}": per_sample([getattr(result, name) for result in results]) for name in names}
