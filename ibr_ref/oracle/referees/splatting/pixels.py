"""Stage resolve, and the picture judged from the case alone: the winners of pixels, their colours and depths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.arithmetic.decisions import joined
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.pipeline.splats import contest, recut
from ibr_ref.oracle.programs.splatting import Port as Program
from ibr_ref.oracle.referees.outcomes import converted, stored
from ibr_ref.oracle.referees.reads import fed
from ibr_ref.oracle.referees.splatting.blends import averages, own_weight, sums, that_agree
from ibr_ref.oracle.referees.splatting.model import NOTHING, Branch, Model, Placed
from ibr_ref.oracle.referees.splatting.points import VISIBLE, Port, lightings
from ibr_ref.oracle.referees.splatting.raster import names_of, pixels_of, system_of
from ibr_ref.oracle.referees.splatting.table import Table
from ibr_ref.oracle.referees.splatting.texels import judge_normals
from ibr_ref.oracle.referees.splatting.verdict import judgement

# --- Outcomes of pixels ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Seen:
    """What pixels may show: n legal pairs of a pixel and the point that wins it. P pixels."""

    pixel: Ints
    winner: Ints
    """As it is named; -1 none."""
    depth: Number
    """(n,) of the depth buffer."""
    judged: Bools
    """(P,) whether all that a pixel may show is here."""

    def take(self, index: Ints | Bools) -> Seen:
        """Some pairs."""
        return Seen(self.pixel[index], self.winner[index], self.depth[index], self.judged)


def seen(model: Model, points: Table, placed: Placed) -> Seen:
    """Every splat that may win, and nothing where nothing may be."""
    result = model.own_contest if placed is model.own_places else contest(model.program, placed)
    bare = np.flatnonzero(result.empty)
    winner = np.concatenate([names_of(model, points, result.splat), np.full(len(bare), -1)])
    depth = joined([result.depth[result.splat], Number(model.machine, np.ones(len(bare)), np.zeros(len(bare)))])
    return Seen(np.concatenate([result.pixel, bare]), winner, depth, np.full(len(result.empty), result.judged))


def named(model: Model, points: Table, placed: Placed, handed: Handed) -> Seen:
    """The splat that the port names for each pixel; one that does not exist was wrong before."""
    winner = np.asarray(handed["raster.splat"]).reshape(-1).astype(np.int64)
    judged = (winner >= -1) & (winner < len(points))
    pixel = np.flatnonzero(judged)
    winner = winner[pixel]
    depth = model.program.stored_depth(recut(model.program, placed).depth)[np.maximum(winner, 0)]
    depth = model.machine.where(winner >= 0, depth, 1.0)
    if "raster.depth" not in handed:
        judged[pixel[~np.isfinite(depth.value)]] = False
    return Seen(pixel, winner, depth, judged)


def tested(model: Model, found: Seen, depth: Floats) -> Seen:
    """Of the outcomes those that the port's own depth buffer (P,) leaves, or all where it leaves none, with its depths."""
    fits = found.depth.allows(depth[found.pixel])
    left = np.zeros(len(depth), np.bool_)
    left[found.pixel[fits]] = True
    kept = found.take(fits | ~left[found.pixel])
    own = depth[kept.pixel]
    read = (converted if model.device.depth_step else stored)(model.machine, own)
    again = np.where(np.isfinite(own), UNIT * np.abs(own), 0.0)  # and stored once more
    return Seen(
        kept.pixel, kept.winner, Number(model.machine, own, read.error + again), kept.judged & np.isfinite(depth)
    )


@dataclass(frozen=True, eq=False)
class Shown:
    """Colours of pixels: m legal pairs."""

    pixel: Ints
    row: Ints
    """Of `Seen`."""
    color: Number
    """(m, 3)."""


def shown(model: Model, found: Seen, branches: Sequence[Branch]) -> Shown:
    """What the picture has where those win."""
    program = model.program
    row, column = np.divmod(found.pixel, pixels_of(model)[1])
    there = np.asarray(program.shown(found.winner) & program.drawn(row, column))
    of, winner = _read(program, found, row, column)
    parts, pieces = [], []
    for k, branch in enumerate(branches):
        legal = branch.legal[winner] & there[of] & (winner >= 0) if k else np.ones(len(of), np.bool_)
        some = np.flatnonzero(legal)
        color = program.picture(branch.color, winner[some], there[of[some]])
        parts.append(of[some])
        pieces.append(model.machine.of(color))
    rows, color = np.concatenate(parts), joined(pieces)
    # Stored as a float32 at the most once more.
    color = Number(model.machine, color.value, color.deviation + UNIT * np.abs(color.value))
    return Shown(found.pixel[rows], rows, color)


def _read(program: Program, found: Seen, row: Ints, column: Ints) -> tuple[Ints, Ints]:
    """Rows of pairs, and the winners whose colours are fetched for them: of another pixel each that may win there."""
    if program.right("read_at"):
        return np.arange(len(found.pixel)), found.winner
    width = program.scene.camera.width
    y, x = program.read_at(row, column)
    order = np.argsort(found.pixel, kind="stable")
    keys = found.pixel[order]
    first, stop = (np.searchsorted(keys, y * width + x, side=side) for side in ("left", "right"))
    of = np.repeat(np.arange(len(row)), stop - first)
    step = np.arange(len(of)) - np.repeat(np.cumsum(stop - first) - (stop - first), stop - first)
    return of, found.winner[order[first[of] + step]]


def colors_of(model: Model, points: Table, placed: Placed, winner: Ints, handed: Handed) -> list[Branch]:
    """Colours of the points that win: the port's own, if it handed them in."""
    if "vertex.color" in handed:
        own = stored(model.machine, np.asarray(handed["vertex.color"], np.float64))
        return [Branch(own, np.ones(len(points), np.bool_))]
    asked = np.unique(winner[winner >= 0]) if model.program.right("splat_color", "read_at") else None
    return model.colors(points, placed.world, asked)


# --- Resolve, and the picture ----------------------------------------------------------------------------------------


def judge_image(port: Port, among: Bools | None = None, *, thorough: bool = False) -> Judgement:
    """The picture from the case alone, its points lit with the case's normals, or with the port's own if these are legal.

    among: (H W,) the pixels that are judged, where each hangs on its own winner. thorough: their colours too, where a depth
    is wrong.
    """
    model, handed = port.model, port.handed
    found = seen(model, model.own, model.own_places)
    if among is not None and model.program.right("read_at"):
        found = replace(found.take(among[found.pixel]), judged=found.judged & among)
        wrong = _without(found.judged, found.pixel[_deep(found, handed)]).reshape(pixels_of(model))
        if wrong.any() and not thorough:  # before any point is lit
            nothing = np.full(wrong.shape, np.nan)
            return judgement("image", "pixel", {"depth": wrong}, np.zeros(wrong.shape, np.bool_), nothing)

    def lit(points: Table) -> Judgement:
        placed, winners = model.own_places, found
        if model.elliptic and points is not model.own:  # its normals are those of other ellipses
            placed = model.placed(points)
            winners = seen(model, points, placed)
        rows, colors = looks(model, winners, points, placed, NOTHING)
        reference = model.case.frame.color.reshape(-1, 3) if model.right is None else _first(rows, colors)
        return _judged(model, "image", handed, rows, colors, reference, ())

    first = lit(model.own)
    reads_normals = model.elliptic or model.case.scene.light is not None
    if "atlas.normal" not in handed or not reads_normals or not first.wrong.any():
        return first
    own = model.table({name: handed[name] for name in ("atlas.rects", "atlas.normal") if name in handed})
    if not own.usable.all() or judge_normals(port).wrong.any():
        return first
    return fewest([first, lit(own)])


def fewest(judgements: Sequence[Judgement]) -> Judgement:
    """The one with the fewest wrong elements."""
    return min(judgements, key=lambda judgement: int(judgement.wrong.sum()))


def judge_resolve(port: Port) -> Judgement:
    """The picture from the port's own winners, vertices and texels, as far as they were handed in."""
    model, handed, points, placed = port.model, port.handed, port.fed, port.landed
    lit = [points] if "vertex.color" in handed else lightings(model, points)
    found = outcomes(port)
    compared = [name for name in ("color", "depth") if name in handed]
    replayed, results = fed("splatting", compared, handed, system_of(model)), []
    for lighting in lit:
        rows, colors = looks(model, found, lighting, placed, handed)
        results.append(_judged(model, "resolve", handed, rows, colors, _first(rows, colors), replayed))
    return fewest(results)


def looks(model: Model, found: Seen, points: Table, placed: Placed, handed: Handed) -> tuple[Seen, Shown]:
    """All that pixels may show, and what it looks like; of ellipses a nearest splat may be in several averages."""
    if not model.elliptic:
        return found, shown(model, found, colors_of(model, points, placed, found.winner, handed))
    weight = own_weight(handed)
    sums_ = sums(model, points, placed, found.pixel, _unnamed(model, points, found.winner))
    if weight is not None:
        sums_ = that_agree(sums_, found.pixel, weight)
    branches = colors_of(model, points, placed, sums_.splat, handed)
    rows = found.take(sums_.row)
    mixed = averages(sums_, model, branches, None if weight is None else weight[rows.pixel])
    rows = replace(rows, judged=_without_lost(rows, mixed.lost))
    index = np.where(mixed.shown, np.arange(len(rows.pixel)), -1)
    colors = shown(model, replace(rows, winner=index), [Branch(mixed.color, np.ones(len(index), np.bool_))])
    return rows, colors


def _without_lost(rows: Seen, lost: Bools) -> Bools:
    judged = rows.judged.copy()
    judged[rows.pixel[lost]] = False
    return judged


def _unnamed(model: Model, points: Table, winner: Ints) -> Ints:
    """Splats by the numbers that winners are known by; the first that has one."""
    if model.program.right("names"):
        return winner
    names = names_of(model, points, np.arange(len(points)))
    order = np.argsort(names, kind="stable")
    at = np.minimum(np.searchsorted(names[order], winner), len(order) - 1)
    return np.where(winner >= 0, order[at], -1)


def _first(found: Seen, colors: Shown) -> Floats:
    """(P, 3) of each pixel's outcomes the first."""
    result = np.full((found.judged.size, 3), np.nan)
    result[colors.pixel[::-1]] = colors.color.value[::-1]
    return result


def outcomes(port: Port) -> Seen:
    """What pixels may show by the port's own winners and depths, as far as they were handed in."""
    model, points, placed, handed = port.model, port.fed, port.landed, port.handed
    found = named(model, points, placed, handed) if "raster.splat" in handed else seen(model, points, placed)
    if "raster.depth" in handed:
        found = tested(model, found, np.asarray(handed["raster.depth"], np.float64).reshape(-1))
    if "vertex.color" in handed:
        numbers = np.asarray(np.isfinite(np.asarray(handed["vertex.color"], np.float64)).all(axis=1))
        lost = found.pixel[(found.winner >= 0) & ~numbers[np.maximum(found.winner, 0)]]
        found.judged[lost] = False
    return found


def _judged(
    model: Model, stage: str, handed: Handed, found: Seen, colors: Shown, reference: Floats, replayed: tuple[str, ...]
) -> Judgement:
    """Depth and colour must agree with one and the same outcome; what is seen is known before how it looks."""
    shape, pixels = pixels_of(model), len(found.judged)
    bad: dict[str, Bools] = {}
    agrees = _deep(found, handed)
    if "depth" in handed:
        bad["depth"] = _without(found.judged, found.pixel[agrees])
    x = colors.color
    bounded = Bounded(x.value, x.deviation, model.machine.device)
    if "color" in handed:
        picture = model.program.rows(np.asarray(handed["color"])).reshape(-1, 3)
        fits = allows_color(bounded, picture[colors.pixel]).all(axis=1)
        bad["color"] = _without(found.judged, colors.pixel[fits & agrees[colors.row]])
    low, high = np.full((pixels, 3), np.inf), np.full((pixels, 3), -np.inf)
    np.minimum.at(low, colors.pixel, x.low)
    np.maximum.at(high, colors.pixel, x.high)
    with np.errstate(invalid="ignore"):
        width = np.where(found.judged, (high - low).max(axis=1), np.nan)
        gap = np.maximum(x.low - reference[colors.pixel], reference[colors.pixel] - x.high).max(axis=1)
    undecided = np.zeros(pixels, np.bool_)
    undecided[colors.pixel[gap > VISIBLE]] = True
    undecided |= ~found.judged & (stage == "image")
    shaped = {name: wrong.reshape(shape) for name, wrong in bad.items()}
    return judgement(stage, "pixel", shaped, undecided.reshape(shape), width.reshape(shape), replayed)


def _deep(found: Seen, handed: Handed) -> Bools:
    """Which outcomes have the depths that were handed in."""
    if "depth" not in handed:
        return np.ones(len(found.pixel), np.bool_)
    return found.depth.allows(np.asarray(handed["depth"], np.float64).reshape(-1)[found.pixel])


def _without(judged: Bools, pixel: Ints) -> Bools:
    """Pixels of which no outcome agrees."""
    left = ~judged
    left[pixel] = True
    return ~left
