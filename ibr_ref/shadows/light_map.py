"""The one map of a scene that lies parallel to its light (`parallel`), and how it is asked (`percentage_closer`)."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.scene import checks
from ibr_ref.scene.vectors import cross, dot, unit
from ibr_ref.shadows import maps, parallel
from ibr_ref.shadows.inputs import Params, Scene
from ibr_ref.shadows.percentage_closer import Filter, Softened, on_map, soften
from ibr_ref.shadows.surface import Surface
from ibr_ref.shadows.vertex import place


def frame_of(scene: Scene, towards: Floats) -> parallel.Frame:
    """The frame of the light, whose plane is that of the axes; h > 0 on the side of the point `towards` (3,)."""
    centre, half_edges = scene.light.arrays
    right, normal = unit(scene.axes[0]), unit(cross(*scene.axes))
    backwards = -normal if dot(normal, towards - centre) > 0.0 else normal
    rows = np.stack([right, cross(backwards, right), backwards])
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = rows, [-dot(row, centre) for row in rows]
    return parallel.Frame(view, np.array([[dot(row, edge) for row in rows[:2]] for edge in half_edges]))


def before_light(scene: Scene, caster: Floats) -> tuple[parallel.Frame, Floats, float]:
    """The light's frame, the caster's corners (U, 3) of its vertices in the world (V, 3), and the nearest one's distance.

    Raises ValueError for a caster that is not wholly on one side of the light's plane.
    """
    drawn = caster[np.unique(scene.caster.triangles)]
    frame = frame_of(scene, drawn.mean(axis=0))
    nearest = float(parallel.distances(frame, drawn).min())
    if not nearest > 0.0:
        raise checks.reject(
            "light.position",
            scene.light.arrays[0].tolist(),
            "a light with the whole caster on one side of its plane, that of offset_axes",
        )
    return frame, drawn, nearest


def map_of(scene: Scene) -> tuple[parallel.Frame, parallel.Window]:
    """The light's frame, and a window around the caster and its penumbra as far as the receivers reach."""
    caster = place(np.asarray(scene.caster.vertices), scene.axes, np.asarray(scene.offset))
    frame, drawn, nearest = before_light(scene, caster)
    corners = [np.asarray(mesh.vertices)[np.unique(mesh.triangles)] for mesh in scene.receivers]
    farthest = max(float(parallel.distances(frame, each).max()) for each in corners)
    return frame, parallel.window_around(frame, drawn, max(farthest, nearest))


def depth_map(scene: Scene, params: Params) -> Floats:
    """(S, S) window depth of the caster in the map that is parallel to the light; 1 where it is not."""
    frame, window = map_of(scene)
    caster = place(np.asarray(scene.caster.vertices), scene.axes, np.asarray(scene.offset))
    view = parallel.view_of_caster(frame, window, caster, np.asarray(scene.caster.triangles))
    return maps.depth(view, np.zeros(2), params.map_size)


def softened(scene: Scene, params: Params, caster: int, depths: Floats, surface: Surface) -> Softened:
    """The shadow of what the camera sees, from a map (S, S) of window depths; triangles from index `caster` on are lit."""
    frame, window = map_of(scene)
    search, points = (on_map(frame, window, count) for count in (params.search_points, params.filter_points))
    wanted = Filter(search, points, float(params.bias), caster)
    distances = parallel.to_distance(depths, window)
    return soften(surface.triangle, surface.varyings, frame, window, distances, wanted)
