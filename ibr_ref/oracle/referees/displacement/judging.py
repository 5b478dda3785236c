"""The arrays of one stage compared with its legal outcomes, element by element."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.displacement.contract import STAGES as CONTRACT
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.programs.displacement.searches.below import Descent
from ibr_ref.oracle.referees.displacement.drawn_faces import judge_faces, other_faces
from ibr_ref.oracle.referees.displacement.replay import Port, march_field, not_covered, raster_field, shade_field
from ibr_ref.oracle.referees.displacement.rows import Hits, Points, Shades
from ibr_ref.oracle.referees.outcomes import judged

VAGUE = 1.0 / 16.0
"""Of the volume's height: hits that far apart say nothing, and count as undecided."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Verdict:
    """Elements of one stage, flat: what `Judgement` holds, before it has the picture's shape."""

    arrays: tuple[str, ...]
    wrong: Bools
    undecided: Bools
    width: Floats
    blame: Any


def judge_vertex(port: Port) -> Judgement:
    """The corners of the faces, or the faces."""
    if other_faces(port):
        return judge_faces(port)
    legal, names = port.model.vertices, port.names("vertex")
    count = len(legal["vertex.clip"])
    wrong, blame = np.zeros(count, np.bool_), np.full(count, -1, np.int8)
    for i, name in enumerate(names):
        found = np.asarray(port.handed[name], np.float64)
        off = ~legal[name].allows(found).all(axis=1)
        blame[off & ~wrong] = i
        wrong |= off
    widths = [2.0 * np.broadcast_to(x.deviation, x.shape).max(axis=1) for x in legal.values()]
    nowhere = np.zeros(count, np.bool_)
    return Judgement(
        stage="vertex",
        element="vertex",
        arrays=names,
        wrong=wrong,
        undecided=nowhere,
        width=np.max(widths, axis=0),
        blame=blame,
    )


def _judged(port: Port, names: Sequence[str], pixel: Ints, fields: Sequence[Any], bare: Ints) -> tuple[Bools, Any]:
    """Outcomes at `pixel` with these fields, and besides nothing at the pixels `bare`."""
    agrees, machine = [], port.model.machine
    for name, field in zip(names, fields, strict=True):
        nothing = float(CONTRACT[name].blank)
        none: Any = np.full(len(bare), nothing)
        if isinstance(field, list):
            none = [Number(machine, none)] * len(field)
        elif isinstance(field, Number):
            none = Number(machine, none)
        else:
            none = np.full(len(bare), int(nothing))
        agrees.append(np.concatenate([port.agreement(name, pixel, field), port.agreement(name, bare, none)]))
    right, blame = judged(np.concatenate([pixel, bare]), agrees, port.pixels)
    return ~right, blame


def _width(pixels: int, pixel: Ints, fields: Sequence[Any]) -> Floats:
    """(pixels,) of the widest of the continuous results; NaN where there is none."""
    result = np.full(pixels, -np.inf)
    for field in fields:
        for x in field if isinstance(field, list) else [field]:
            if isinstance(x, Number) and len(pixel):
                np.maximum.at(result, pixel, np.where(np.isnan(x.value), -np.inf, 2.0 * x.deviation))
    return np.where(np.isfinite(result), result, np.nan)


def _boundless(pixels: int, pixel: Ints, fields: Sequence[Any]) -> Bools:
    """(pixels,) where a result may be anything: that says nothing, and counts as undecided."""
    result = np.zeros(pixels, np.bool_)
    for field in fields:
        for x in field if isinstance(field, list) else [field]:
            if isinstance(x, Number):
                result[pixel[np.isinf(x.deviation) & ~np.isnan(x.value)]] = True
    return result


def _apart(pixels: int, hits: Hits) -> Floats:
    """(pixels,) from the lowest to the highest hit."""
    low, high, kept = np.full(pixels, np.inf), np.full(pixels, -np.inf), hits.take(hits.kept)
    np.minimum.at(low, kept.pixel, kept.hit[2].low)
    np.maximum.at(high, kept.pixel, kept.hit[2].high)
    return np.asarray(np.maximum(high - low, 0.0), np.float64)


def _several(pixels: int, pixel: Ints) -> Bools:
    """(pixels,) where there is more than one outcome."""
    return np.asarray(np.bincount(pixel, minlength=pixels) > 1, np.bool_)


def judge_raster(port: Port, candidates: Points) -> Verdict:
    """Face, polygon and point of what covers each pixel."""
    names = port.names("raster")
    fields = [raster_field(port, candidates, name) for name in names]
    open_ = not_covered(candidates, port.pixels)
    wrong, blame = _judged(port, names, candidates.pixel, fields, np.flatnonzero(open_))
    perhaps = np.zeros(port.pixels, np.bool_)
    perhaps[candidates.pixel] = True
    return Verdict(
        arrays=names,
        wrong=wrong,
        undecided=(perhaps & open_) | _boundless(port.pixels, candidates.pixel, fields),
        width=_width(port.pixels, candidates.pixel, fields),
        blame=blame,
    )


def judge_march(port: Port, hits: Hits, bare: Bools, points: Points, lost: Ints) -> Verdict:
    """What the march found."""
    names = port.names("march")
    fields = [march_field(hits, name) for name in names]
    wrong, blame = _judged(port, names, hits.pixel, fields, np.flatnonzero(bare))
    known = bare.copy()
    known[points.pixel] = True
    least, most = np.full(port.pixels, np.inf), np.full(port.pixels, -np.inf)
    np.minimum.at(least, hits.pixel, hits.hit_index.astype(np.float64))
    np.maximum.at(most, hits.pixel, hits.hit_index.astype(np.float64))
    undecided = most - least > 1
    if isinstance(port.model.program, Descent):  # its indices do not say how far apart hits are
        undecided |= _apart(port.pixels, hits) > VAGUE
    undecided |= _boundless(port.pixels, hits.pixel, fields)
    wrong[lost], undecided[lost] = False, True
    width = _width(port.pixels, hits.pixel, fields)
    return Verdict(arrays=names, wrong=wrong & known, undecided=undecided, width=width, blame=blame)


def _agree(color: list[Number], found: Any, at: Any = slice(None)) -> Bools:
    """Whether colours are legal."""
    some = [x[at] for x in color]
    value = np.stack([x.value for x in some], axis=-1)
    error = np.stack([np.broadcast_to(x.deviation, x.shape) for x in some], axis=-1)
    return np.asarray(allows_color(Bounded(value, error, color[0].do.device), found).all(axis=1), np.bool_)


def judge_shade(port: Port, hits: Hits, shades: Shades, lit_pixel: Ints, color: list[Number], lost: Ints) -> Verdict:
    """Looks, and colours where they are handed in."""
    names = port.names("shade")
    fields = [shade_field(shades, name) for name in names]
    discarded = _discarded(port, hits)
    wrong, blame = _judged(port, names, shades.pixel, fields, np.flatnonzero(discarded))
    judged_here = discarded.copy()
    judged_here[hits.pixel] = True
    wrong &= judged_here
    if "color" in port.handed:
        found = port.model.program.rows(np.asarray(port.handed["color"])).reshape(port.pixels, 3)
        bright, _ = judged(lit_pixel, [_agree(color, found[lit_pixel])], port.pixels)
        unseen = np.ones(port.pixels, np.bool_)
        unseen[lit_pixel] = False
        unseen[hits.pixel[hits.depth.high >= 1.0]] = True
        dark = ~(bright | unseen)
        blame[dark & ~wrong] = len(names)
        wrong = wrong | dark
        names = (*names, "color")
    undecided = _several(port.pixels, shades.pixel) | _boundless(port.pixels, shades.pixel, fields)
    undecided |= _boundless(port.pixels, lit_pixel, [color])
    wrong[lost], undecided[lost] = False, True
    return Verdict(
        arrays=names,
        wrong=wrong,
        undecided=undecided,
        width=_width(port.pixels, shades.pixel, fields),
        blame=blame,
    )


def _discarded(port: Port, hits: Hits) -> Bools:
    """(pixels,) that have no hit by the port's own account, or by the program's where it gave none."""
    if "march.hit_index" in port.handed:
        return port.ints("march.hit_index") < 0
    result = np.ones(port.pixels, np.bool_)
    result[hits.pixel] = False
    return result | port.picture.winners.empty


def judge_resolve(port: Port, hits: Hits, lit: Ints, color: list[Number], clean: bool, lost: Ints) -> Verdict:
    """Depth, what is shown where polygons hide one another, and the background.

    Which polygon wins hangs on fragments that the port did not hand in. They are the program's only where the port's own
    stages are right: `clean`. The colours of what is shown were judged with shade; they count here where it was not.
    """
    names = tuple(name for name in ("depth", "color") if name in port.handed)
    nothing = _discarded(port, hits)
    nothing[hits.pixel[hits.depth.high >= 1.0]] = True
    bare = np.flatnonzero(nothing & port.picture.winners.empty if clean else nothing)
    may_win = hits.depth.low < 1.0
    if clean:
        may_win &= _may_win(port, hits)
    colors_too = "color" in names and not port.names("shade")
    row = np.flatnonzero(may_win[lit])
    entry = lit[row] if colors_too else np.flatnonzero(may_win)
    pixel = np.concatenate([hits.pixel[entry], bare])
    agrees = []
    if "depth" in names:
        shown, one = hits.depth[entry], np.ones(len(bare))
        error = np.concatenate([shown.deviation + 0.0 * shown.value, 0.0 * one + port.model.device.depth_step])
        depth = Number(port.model.machine, np.concatenate([shown.value, one]), error)
        agrees.append(port.agreement("depth", pixel, depth))
    if "color" in names:
        found = port.model.program.rows(np.asarray(port.handed["color"])).reshape(port.pixels, 3)
        behind = [port.model.machine.lanes(x, bare) for x in port.model.background]
        before: Bools = np.ones(len(entry), np.bool_)
        if colors_too:
            before = _agree(color, found[hits.pixel[entry]], row)
        agrees.append(np.concatenate([before, _agree(behind, found[bare])]))
    right, blame = judged(pixel, agrees, port.pixels)
    known = np.zeros(port.pixels, np.bool_)
    known[hits.pixel] = True
    known |= nothing
    wrong = ~right & known
    undecided = _several(port.pixels, pixel) | _boundless(port.pixels, hits.pixel[hits.kept], [hits.depth[hits.kept]])
    for many in (lost, port.picture.fragments.pixel[port.picture.lost]):
        wrong[many], undecided[many] = False, True
    return Verdict(
        arrays=names,
        wrong=wrong,
        undecided=undecided,
        width=_width(port.pixels, hits.pixel, [hits.depth]),
        blame=blame,
    )


def _may_win(port: Port, hits: Hits) -> Bools:
    """Which hits are of a polygon that the depth test may leave at its pixel."""
    picture, count = port.picture, port.polygons
    possible = picture.possible & (picture.all.hit_index >= 0)
    looks = picture.all
    return np.isin(hits.pixel * count + hits.polygon, np.unique((looks.pixel * count + looks.polygon)[possible]))
