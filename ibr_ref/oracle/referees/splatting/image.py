"""Stage resolve, and the picture judged from the case alone: the colour and depth of a pixel's winner."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bounded import Bounded, exact, uploaded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import UNIT, Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.splatting.lighting import Shades, shades
from ibr_ref.oracle.referees.splatting.place import Landed, landed, placed, world_points
from ibr_ref.oracle.referees.splatting.splats import buffered, contest, single
from ibr_ref.oracle.referees.splatting.table import Table, table
from ibr_ref.oracle.referees.splatting.verdict import judgement

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

VISIBLE = 1.0 / 255.0
"""Colours farther apart than one byte show."""


@dataclass(frozen=True, eq=False)
class Outcomes:
    """What pixels may show: n legal pairs of a pixel and what it shows. P pixels."""

    pixel: Ints
    color: Bounded
    """(n, 3)."""
    depth: Bounded
    """(n,)."""
    judged: Bools
    """(P,) whether all that a pixel may show is here."""


def judge_image(case: Case, device: Device, handed: Handed) -> Judgement:
    """The picture from the case alone."""
    points = table(case, device)
    found = seen(case, device, points, placed(case, device, points), {})
    return _judged("image", case, handed, found, case.frame.color.reshape(-1, 3), ())


def judge_resolve(case: Case, device: Device, handed: Handed) -> Judgement:
    """The picture from the port's own winners and vertices, as far as they were handed in."""
    points = table(case, device)
    where, fed = landed(case, device, points, handed)
    fed = tuple(name for name in ("raster.splat", "raster.depth", "vertex.color", *fed) if name in handed)
    if "raster.splat" in handed:
        found = named(case, device, points, where, handed)
    else:
        found = seen(case, device, points, where, handed)
    reference = np.full((case.scene.camera.width * case.scene.camera.height, 3), np.nan)
    reference[found.pixel[::-1]] = found.color.value[::-1]
    return _judged("resolve", case, handed, found, reference, fed)


def seen(case: Case, device: Device, points: Table, where: Landed, handed: Handed) -> Outcomes:
    """Every splat that may win, with both branches of its colour; and the background."""
    camera = case.scene.camera
    result = contest(where, case.params.shape, camera.width, camera.height)
    shown, at = np.unique(result.splat, return_inverse=True)
    colors = vertex_colors(case, device, points, shown, handed)[at.reshape(-1)]
    pixels = np.flatnonzero(result.empty)
    judged = np.full(len(result.empty), result.judged)
    return _outcomes(case, device, result.pixel, colors, result.depth[result.splat], pixels, judged)


def named(case: Case, device: Device, points: Table, where: Landed, handed: Handed) -> Outcomes:
    """The splat that the port names for each pixel; one that does not exist was wrong before."""
    splat = np.asarray(handed["raster.splat"]).reshape(-1).astype(np.int64)
    exists = (splat >= 0) & (splat < len(points.rows))
    pixel = np.flatnonzero(exists)
    shown, at = np.unique(splat[pixel], return_inverse=True)
    colors = vertex_colors(case, device, points, shown, handed)[at.reshape(-1)]
    judged = exists | (splat == -1)
    judged[pixel[~np.isfinite(colors.color.value).all(axis=1)]] = False
    depth = buffered(where.depth)[splat[pixel]]
    empty = np.flatnonzero(splat == -1)
    found = _outcomes(case, device, pixel, colors, depth, empty, judged)
    if "raster.depth" not in handed:
        unknown = ~np.isfinite(depth.value)
        judged[pixel[unknown]] = False
        return found
    stored = np.asarray(handed["raster.depth"], np.float64).reshape(-1)
    return Outcomes(found.pixel, found.color, single(device, stored[found.pixel]), judged & np.isfinite(stored))


def vertex_colors(case: Case, device: Device, points: Table, vertices: Ints, handed: Handed) -> Shades:
    """Colours of some vertices: the port's own, if it handed them in."""
    if "vertex.color" in handed:
        own = exact(np.asarray(handed["vertex.color"], np.float64)[vertices], device)
        return Shades(own, own, np.zeros(len(vertices), np.bool_))
    world = [coordinate[vertices] for coordinate in world_points(case, device, points)]
    return shades(case, device, world, points.codes[vertices], points.albedo[vertices])


def _outcomes(
    case: Case, device: Device, pixel: Ints, colors: Shades, depth: Bounded, empty: Ints, judged: Bools
) -> Outcomes:
    """Both branches of the splats' colours, and the background where nothing may be."""
    background = uploaded(np.tile(np.asarray(case.scene.background, np.float64), (len(empty), 1)), device)
    parts = [(pixel, colors.color, depth), (empty, background, exact(np.ones(len(empty)), device))]
    if colors.split.any():
        parts.append((pixel[colors.split], colors.other[colors.split], depth[colors.split]))
    values = [np.concatenate([getattr(part[k], name) for part in parts]) for k in (1, 2) for name in ("value", "error")]
    color = Bounded(
        values[0], values[1] + UNIT * np.abs(values[0]), device
    )  # stored as a float32 at the most once more
    return Outcomes(np.concatenate([part[0] for part in parts]), color, Bounded(values[2], values[3], device), judged)


def _judged(
    stage: str, case: Case, handed: Handed, found: Outcomes, reference: Floats, fed: tuple[str, ...]
) -> Judgement:
    """Depth and colour must agree with one and the same outcome; what is seen is known before how it looks."""
    shape = (case.scene.camera.height, case.scene.camera.width)
    pixels = shape[0] * shape[1]
    agrees, bad = np.ones(len(found.pixel), np.bool_), {}
    if "depth" in handed:
        agrees &= found.depth.allows(np.asarray(handed["depth"], np.float64).reshape(-1)[found.pixel])
        bad["depth"] = _without(found, agrees, pixels)
    if "color" in handed:
        picture = np.asarray(handed["color"]).reshape(-1, 3)
        agrees &= allows_color(found.color, picture[found.pixel]).all(axis=1)
        bad["color"] = _without(found, agrees, pixels)
    low, high = np.full((pixels, 3), np.inf), np.full((pixels, 3), -np.inf)
    np.minimum.at(low, found.pixel, found.color.low)
    np.maximum.at(high, found.pixel, found.color.high)
    width = np.where(found.judged, (high - low).max(axis=1), np.nan)
    gap = np.maximum(found.color.low - reference[found.pixel], reference[found.pixel] - found.color.high).max(axis=1)
    undecided = np.zeros(pixels, np.bool_)
    undecided[found.pixel[gap > VISIBLE]] = True
    undecided |= ~found.judged & (stage == "image")
    shaped = {name: wrong.reshape(shape) for name, wrong in bad.items()}
    return judgement(stage, "pixel", shaped, undecided.reshape(shape), width.reshape(shape), fed)


def _without(found: Outcomes, agrees: Bools, pixels: int) -> Bools:
    """Pixels of which no outcome agrees."""
    left = ~found.judged
    left[found.pixel[agrees]] = True
    return ~left
