"""Why a frame of displaced polygons is empty."""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement.inputs import Params, Scene, check, check_eye
from ibr_ref.displacement.patch_space import uniforms
from ibr_ref.displacement.vertex import vertex_stage
from ibr_ref.pipeline.culling import Culled, fates_of_triangles
from ibr_ref.pipeline.culling import culled as counted


def culled(scene: Scene, params: Params | None = None) -> Culled:
    """What becomes of the faces of the displaced volumes, before the search and the depth test.

    Where some are in the picture and the frame is empty all the same, no line of sight through them meets the shape.
    Raises ValueError where `render` does.
    """
    params = Params() if params is None else params
    check(scene, params)
    width, height = scene.camera.width, scene.camera.height
    candidates = 1 if params.drawn_faces != "auxiliary" else 6 if params.interval == "volume" else 5
    fates, away = [np.empty(0, np.int64)], 0
    for polygon in scene.polygons:
        constants = uniforms(polygon, scene.camera, scene.light)
        check_eye(params, constants.eye)
        faces = vertex_stage(constants, params.drawn_faces, params.interval)
        of_triangles = fates_of_triangles(faces.clip, faces.triangles, width, height)
        fates.append(of_triangles.reshape(-1, 2).max(axis=1))
        away += candidates - len(faces.numbers)
    return counted("face", np.concatenate(fates), away)
