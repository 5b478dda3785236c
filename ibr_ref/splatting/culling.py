"""Why a frame of splats is empty."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.pipeline.culling import DRAWN, FAR, NEAR, OUTSIDE, SMALL, Culled
from ibr_ref.pipeline.culling import culled as counted
from ibr_ref.pipeline.transform import transformed
from ibr_ref.pipeline.triangles import SUBPIXELS
from ibr_ref.splatting.inputs import Params, Scene
from ibr_ref.splatting.references import prepare
from ibr_ref.splatting.render import render
from ibr_ref.splatting.unproject import world_points


def culled(scene: Scene, params: Params | None = None) -> Culled:
    """What becomes of the points, before the depth test: their frame is rendered with its stages.

    A point counts as outside if the box around its splat is beside the picture. Raises ValueError where `render` does.
    """
    params = Params() if params is None else params
    stages = render(scene, params).stages
    window, size = stages["vertex.window"], (scene.camera.width, scene.camera.height)
    dropped, depths = np.isnan(window[:, 0]), _view_depths(scene)
    half = stages["vertex.width"][:, None] / 2.0
    beside = ((window + half <= 0.0) | (window - half >= np.array(size))).any(axis=1)
    fates = np.where(_covers(stages, params, size), DRAWN, np.where(beside, OUTSIDE, SMALL))
    near = np.array(scene.camera.near)
    return counted("point", np.where(dropped, np.where(depths <= near, NEAR, FAR), fates))


def _view_depths(scene: Scene) -> Floats:
    """(V,) along the view axis."""
    references = [prepare(image).reference for image in scene.images]
    points = np.concatenate([world_points(reference)[reference.pixels] for reference in references])
    return 0.0 - transformed(scene.camera.view_from_world, points)[:, 2]


def _covers(stages: dict[str, Floats], params: Params, size: tuple[int, int]) -> NDArray[np.bool_]:
    """(V,) whether a splat covers the pixel's centre that is nearest to it: if any, it does."""
    window = np.rint(stages["vertex.window"] * SUBPIXELS) / SUBPIXELS
    half = stages["vertex.width"] / 2.0
    off = np.clip(np.ceil(window - 1.0), 0.0, np.array(size) - 1.0) + 0.5 - window
    x, y = off.T
    in_box: NDArray[np.bool_] = np.asarray((off >= -half[:, None]).all(axis=1) & (off < half[:, None]).all(axis=1))
    if params.shape == "square":
        return in_box
    if params.shape == "disc":
        return np.asarray(in_box & (x * x + y * y <= half * half))
    xx, xy, yy = stages["vertex.covariance"].T
    return np.asarray(in_box & (yy * x * x - 2.0 * xy * x * y + xx * y * y <= params.cutoff**2 * (xx * yy - xy * xy)))
