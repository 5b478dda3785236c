"""Stage resolve, and the picture judged from the case alone: the colour and depth of a pixel's winner."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded, converted, exact, stored, uploaded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import UNIT, Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.reads import fed
from ibr_ref.oracle.referees.splatting import normals
from ibr_ref.oracle.referees.splatting.lighting import Shades, shades
from ibr_ref.oracle.referees.splatting.place import Landed, landed, placed, world_points
from ibr_ref.oracle.referees.splatting.splats import buffered, contest
from ibr_ref.oracle.referees.splatting.table import Table, fed_table, table
from ibr_ref.oracle.referees.splatting.verdict import judgement

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
    """The picture from the case alone, its points lit with the case's normals, or with the port's own if these are legal."""
    points = table(case, device)
    where = placed(case, device, points)

    def lit(points: Table) -> Judgement:
        found = seen(case, device, points, where, {})
        return _judged("image", case, handed, found, case.frame.color.reshape(-1, 3), ())

    judgement = lit(points)
    if "atlas.normal" not in handed or case.scene.light is None or not judgement.wrong.any():
        return judgement
    own = table(case, device, {name: handed[name] for name in ("atlas.rects", "atlas.normal") if name in handed})
    if not own.usable.all() or normals.judge(case, device, handed).wrong.any():
        return judgement
    return _fewest([judgement, lit(own)])


def _fewest(judgements: Sequence[Judgement]) -> Judgement:
    return min(judgements, key=lambda judgement: int(judgement.wrong.sum()))


def judge_resolve(case: Case, device: Device, handed: Handed) -> Judgement:
    """The picture from the port's own winners, vertices and texels, as far as they were handed in."""
    points = fed_table(case, device, handed)
    lightings = [points] if "vertex.color" in handed else points.lightings
    return _fewest([_resolved(case, device, handed, each) for each in lightings])


def _resolved(case: Case, device: Device, handed: Handed, points: Table) -> Judgement:
    where = landed(case, device, points, handed)
    if "raster.splat" in handed:
        found = named(case, device, points, where, handed)
    else:
        found = seen(case, device, points, where, handed)
    if "raster.depth" in handed:
        found = tested(found, np.asarray(handed["raster.depth"], np.float64).reshape(-1))
    reference = np.full((case.scene.camera.width * case.scene.camera.height, 3), np.nan)
    reference[found.pixel[::-1]] = found.color.value[::-1]
    compared = [name for name in ("color", "depth") if name in handed]
    return _judged("resolve", case, handed, found, reference, fed("splatting", compared, handed))


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
    if "raster.depth" not in handed:
        unknown = ~np.isfinite(depth.value)
        judged[pixel[unknown]] = False
    return _outcomes(case, device, pixel, colors, depth, empty, judged)


def tested(found: Outcomes, depth: Floats) -> Outcomes:
    """Of the outcomes those that the port's own depth buffer (P,) leaves, or all where it leaves none, with its depths."""
    fits = found.depth.allows(depth[found.pixel])
    left = np.zeros(len(depth), np.bool_)
    left[found.pixel[fits]] = True
    kept = fits | ~left[found.pixel]
    own, device = depth[found.pixel[kept]], found.depth.device
    read = converted(own, device) if device.depth_step else stored(own, device)
    read = read.widened(np.where(np.isfinite(own), UNIT * np.abs(own), 0.0))  # and stored once more
    return Outcomes(found.pixel[kept], found.color[kept], read, found.judged & np.isfinite(depth))


def vertex_colors(case: Case, device: Device, points: Table, vertices: Ints, handed: Handed) -> Shades:
    """Colours of some vertices: the port's own, if it handed them in."""
    if "vertex.color" in handed:
        own = stored(np.asarray(handed["vertex.color"], np.float64)[vertices], device)
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
    stage: str, case: Case, handed: Handed, found: Outcomes, reference: Floats, replayed: tuple[str, ...]
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
    return judgement(stage, "pixel", shaped, undecided.reshape(shape), width.reshape(shape), replayed)


def _without(found: Outcomes, agrees: Bools, pixels: int) -> Bools:
    """Pixels of which no outcome agrees."""
    left = ~found.judged
    left[found.pixel[agrees]] = True
    return ~left
