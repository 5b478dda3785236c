"""Stage raster: replayed from the port's own points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.reads import fed
from ibr_ref.oracle.referees.splatting.place import landed
from ibr_ref.oracle.referees.splatting.splats import Contest, contest
from ibr_ref.oracle.referees.splatting.table import Table, fed_table
from ibr_ref.oracle.referees.splatting.verdict import judgement
from ibr_ref.splatting.contract import STAGES

ARRAYS = ("raster.splat", "raster.depth", "raster.overdraw")
"""raster.margin is what the reference knows of itself; a port need not have it, and it is not compared."""


def judge(case: Case, device: Device, handed: Handed) -> Judgement:
    """Every pixel: a splat that may win it, with its own depth, and as many splats as may cover it."""
    camera = case.scene.camera
    splats = fed_table(case, device, handed)
    points = landed(case, device, splats, handed)
    result = contest(points, case.params.shape, camera.width, camera.height, twins(case, splats, handed))
    pixels = camera.width * camera.height
    given = {name: np.asarray(handed[name]).reshape(pixels) for name in ARRAYS if name in handed}
    bad = _contradictions(result, given)
    wins = np.bincount(result.pixel, minlength=pixels) + result.empty
    undecided = (wins > 1) | (not result.judged)
    width = np.full(pixels, np.nan)
    np.fmax.at(width, result.pixel, 2.0 * result.depth.error[result.splat])
    shape = (camera.height, camera.width)
    shaped = {name: (wrong & result.judged).reshape(shape) for name, wrong in bad.items()}
    return judgement(
        "raster", "pixel", shaped, undecided.reshape(shape), width.reshape(shape), fed("splatting", shaped, handed)
    )


def _contradictions(result: Contest, given: dict[str, NDArray[np.generic]]) -> dict[str, Bools]:
    """Of the arrays that were handed in: where one contradicts every outcome that agrees with those before it."""
    bad: dict[str, Bools] = {}
    agrees, empty = np.ones(len(result.pixel), np.bool_), result.empty.copy()
    if "raster.splat" in given:
        found = given["raster.splat"].astype(np.int64)
        agrees &= result.splat == found[result.pixel]
        empty &= found == STAGES["raster.splat"].blank
        bad["raster.splat"] = ~_any(result, agrees, empty)
    if "raster.depth" in given:
        depth = given["raster.depth"].astype(np.float64)
        agrees &= result.depth[result.splat].allows(depth[result.pixel])
        empty &= depth == STAGES["raster.depth"].blank
        bad["raster.depth"] = ~_any(result, agrees, empty)
    if "raster.overdraw" in given:
        count = given["raster.overdraw"].astype(np.int64)
        needed = np.maximum(result.least, ~empty) if len(given) > 1 else result.least
        bad["raster.overdraw"] = (count < needed) | (count > result.most)
    return bad


def _any(result: Contest, agrees: Bools, empty: Bools) -> Bools:
    """Pixels that have an outcome left."""
    left = empty.copy()
    left[result.pixel[agrees]] = True
    return left


def twins(case: Case, splats: Table, handed: Handed) -> Ints | None:
    """(V,) for each point the first one that is the same: of the same pixel, depth and camera, and handed in the same.

    Whatever a device does, it does the same for both, so that they tie. None: the port's own numbers are not known.
    """
    names = [name for name in ("vertex.window", "vertex.depth", "vertex.width") if name in handed]
    if len(names) < 3:
        return None
    cameras = [_seen_by(image.camera) for image in case.scene.images]
    if len(set(cameras)) == len(cameras):
        return None
    keys = np.repeat([cameras.index(camera) for camera in cameras], np.diff(splats.starts))
    columns = [keys, splats.rows, splats.columns, splats.depth.value]
    columns += [np.asarray(handed[name], np.float64).reshape(len(keys), -1).T for name in names]
    rows = np.ascontiguousarray(np.vstack(columns).T, np.float64)
    _, first, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True, equal_nan=False)
    return np.asarray(first[inverse.reshape(-1)], np.int64)


def _seen_by(camera: Any) -> bytes:
    """What a point of a reference camera hangs on."""
    return b"".join(np.asarray(m, np.float64).tobytes() for m in (camera.world_from_view, camera.intrinsics))
