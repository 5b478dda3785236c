"""Why a frame of meshes is empty, and what the light's frustum cuts off the caster, and so off its shadow."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ibr_ref.pipeline.culling import Culled, cut_triangles, fates_of_triangles
from ibr_ref.pipeline.culling import culled as counted
from ibr_ref.shadows.ensemble import Ensemble
from ibr_ref.shadows.inputs import Params, Scene
from ibr_ref.shadows.maps import positions
from ibr_ref.shadows.samples import samples_of, seen_offset, widened_range
from ibr_ref.shadows.vertex import place, to_clip


class Cut(NamedTuple):
    """What of the caster the light's frustum does not hold, at the place where most of it is cut."""

    total: int
    """Triangles of the caster."""
    cut: int
    """Of these, those that leave the light's frustum, in part or wholly."""
    near: int
    far: int
    beside: int
    """By the near plane, the far plane, the sides of the map."""

    def words(self) -> str:
        """Such as "of 12 triangles 4 leave it: 0 by the near plane, 0 by the far plane, 4 by the map's sides"."""
        return (
            f"of {self.total:,} triangles {self.cut:,} leave it: {self.near:,} by the near plane, {self.far:,} by the far "
            f"plane, {self.beside:,} by the map's sides"
        )


def culled(scene: Scene | Ensemble) -> Culled:
    """What becomes of the triangles of receivers and casters, before the depth test."""
    meshes = [(np.asarray(mesh.vertices), np.asarray(mesh.triangles)) for mesh in scene.receivers]
    meshes += [
        (place(np.asarray(mesh.vertices), axes, offset), np.asarray(mesh.triangles))
        for mesh, axes, offset in scene.movers
    ]
    camera = scene.camera
    fates = [
        fates_of_triangles(
            to_clip(vertices, camera.view_from_world, camera.clip_from_view), triangles, camera.width, camera.height
        )
        for vertices, triangles in meshes
    ]
    return counted("triangle", np.concatenate(fates))


def cut_by_light(scene: Scene, params: Params | None = None, *, of_maps: bool = False) -> Cut:
    """What the light's frustum cuts off the caster, and so off its shadow.

    Of the places where the light samples see it, that counts where most triangles are cut; with `of_maps`, of the nine
    places that `prepare` renders maps for: what is cut there is missing from warps. Raises ValueError where `render` does.
    """
    params = Params() if params is None else params
    samples = samples_of(scene, params)
    places = [seen_offset(scene, sample) for sample in samples]
    if of_maps:
        own = np.array(scene.on_axes(scene.light.arrays[0]))
        places = list(positions(*widened_range(scene, samples), own).reshape(-1, 2))
    camera = scene.light.camera(params.map_size)
    triangles = np.asarray(scene.caster.triangles)
    found = []
    for offset in places:
        vertices = place(np.asarray(scene.caster.vertices), scene.axes, offset)
        clip = to_clip(vertices, camera.view_from_world, camera.clip_from_view)
        found.append(cut_triangles(clip, triangles))
    return Cut(len(triangles), *max(found))
