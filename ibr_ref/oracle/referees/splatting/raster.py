"""Stage raster: the winners of pixels, their depths, how many splats cover them, and the sums over ellipses."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.pipeline.splats import Contest, contest
from ibr_ref.oracle.referees.reads import fed
from ibr_ref.oracle.referees.splatting.blends import SUMS, sums
from ibr_ref.oracle.referees.splatting.model import Model
from ibr_ref.oracle.referees.splatting.points import Port
from ibr_ref.oracle.referees.splatting.table import Table
from ibr_ref.oracle.referees.splatting.verdict import judgement
from ibr_ref.splatting.contract import STAGES

ARRAYS = ("raster.splat", "raster.depth", "raster.overdraw")
"""raster.margin is what the reference knows of itself; a port need not have it, and it is not compared."""


def pixels_of(model: Model) -> tuple[int, int]:
    """Rows and columns of the picture."""
    camera = model.case.scene.camera
    return int(camera.height), int(camera.width)


def system_of(model: Model) -> str:
    """What the judged one reads."""
    return str(model.case.params.shape)


def names_of(model: Model, points: Table, splat: Ints) -> Ints:
    """The numbers that winners are known by."""
    return np.asarray(model.program.names(points.image, splat), np.int64)


def judge_raster(port: Port) -> Judgement:
    """Every pixel: a splat that may win it, with its own depth, and as many splats as may cover it."""
    model, handed = port.model, port.handed
    result = contest(model.program, port.landed)
    shape = pixels_of(model)
    pixels = shape[0] * shape[1]
    names = (*ARRAYS, *SUMS) if model.elliptic else ARRAYS
    given = {name: np.asarray(handed[name]).reshape(pixels) for name in names if name in handed}
    bad = _contradictions(result, names_of(model, port.fed, result.splat), given)
    if model.elliptic:
        bad |= _wrong_sums(port, result, given)
    undecided = (np.bincount(result.pixel, minlength=pixels) + result.empty > 1) | (not result.judged)
    width = np.full(pixels, np.nan)
    np.fmax.at(width, result.pixel, 2.0 * result.depth.deviation[result.splat])
    shaped = {name: (wrong & result.judged).reshape(shape) for name, wrong in bad.items()}
    replayed = fed("splatting", shaped, handed, system_of(model))
    return judgement("raster", "pixel", shaped, undecided.reshape(shape), width.reshape(shape), replayed)


def _wrong_sums(port: Port, result: Contest, given: dict[str, Ints | Floats]) -> dict[str, Bools]:
    """Of the sums over ellipses: where one contradicts all that may be added up, with a nearest splat that agrees."""
    model, asked = port.model, [name for name in SUMS if name in given]
    if not asked:
        return {}
    agrees, empty = _agreeing(result, names_of(model, port.fed, result.splat), given)
    none = ~empty
    none[result.pixel[agrees]] = False  # the nearest was wrong before
    agrees |= none[result.pixel]
    rows = np.flatnonzero(agrees)
    found = sums(model, port.fed, port.landed, result.pixel[rows], result.splat[rows])
    pixel, fits, bad = result.pixel[rows][found.row], np.ones(len(found.row), np.bool_), {}
    empty |= none & result.empty
    for name in asked:
        array = given[name]
        own = found.weight.allows(array[pixel]) if name == "raster.weight" else found.count == array[pixel]
        fits &= own | found.lost
        empty &= array == STAGES[name].blank
        left = empty.copy()
        left[pixel[fits]] = True
        bad[name] = ~left
    return bad


def _agreeing(result: Contest, names: Ints, given: dict[str, Ints | Floats]) -> tuple[Bools, Bools]:
    """Which pairs have the winners and depths that were handed in, and which pixels may be empty by these."""
    agrees, empty = np.ones(len(result.pixel), np.bool_), result.empty.copy()
    if "raster.splat" in given:
        found = given["raster.splat"].astype(np.int64)
        agrees &= names == found[result.pixel]
        empty &= found == STAGES["raster.splat"].blank
    if "raster.depth" in given:
        depth = given["raster.depth"].astype(np.float64)
        agrees &= result.depth[result.splat].allows(depth[result.pixel])
        empty &= depth == STAGES["raster.depth"].blank
    return agrees, empty


def _contradictions(result: Contest, names: Ints, given: dict[str, Ints | Floats]) -> dict[str, Bools]:
    """Of the arrays that were handed in: where one contradicts every outcome that agrees with those before it."""
    bad: dict[str, Bools] = {}
    agrees, empty = np.ones(len(result.pixel), np.bool_), result.empty.copy()

    def left() -> Bools:
        found = empty.copy()
        found[result.pixel[agrees]] = True
        return found

    if "raster.splat" in given:
        found = given["raster.splat"].astype(np.int64)
        agrees &= names == found[result.pixel]
        empty &= found == STAGES["raster.splat"].blank
        bad["raster.splat"] = ~left()
    if "raster.depth" in given:
        depth = given["raster.depth"].astype(np.float64)
        agrees &= result.depth[result.splat].allows(depth[result.pixel])
        empty &= depth == STAGES["raster.depth"].blank
        bad["raster.depth"] = ~left()
    if "raster.overdraw" in given:
        count = given["raster.overdraw"].astype(np.int64)
        needed = np.maximum(result.least, ~empty) if len(given) > 1 else result.least
        bad["raster.overdraw"] = (count < needed) | (count > result.most)
    return bad
