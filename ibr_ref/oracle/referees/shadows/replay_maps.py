"""Replay of the stages maps, controls and warp."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.referees.outcomes import stored
from ibr_ref.oracle.referees.reads import fed
from ibr_ref.oracle.referees.shadows import maps, places
from ibr_ref.oracle.referees.shadows.inputs import RENDERED, Inputs, Spot
from ibr_ref.oracle.referees.shadows.judging import judgement
from ibr_ref.oracle.referees.shadows.model import stacked


def positions(given: Inputs) -> Judgement | None:
    """Where the object stands in the nine maps."""
    found = given.own("maps.positions", sampled=False)
    if found is None or not given.warps:
        return None
    legal = given.model.bounded(given.model.program.positions())
    right, width = np.asarray(legal.allows(found).all(axis=-1)), 2.0 * legal.error.max(axis=-1)
    return judgement("maps", "map", ["maps.positions"], [right], width)


def images(given: Inputs) -> Judgement | None:
    """The nine maps, at the port's own positions."""
    found = given.own("maps.image", sampled=False)
    if found is None or not given.warps:
        return None
    program, model = given.model.program, given.model
    own, legal = given.own("maps.positions", sampled=False), program.positions()
    at = legal if own is None else stored(model.machine, own, legal)
    usable = np.asarray(np.ones((3, 3)) if own is None else np.isfinite(own).all(axis=-1), np.bool_)
    at = [[at[j, i] if usable[j, i] else legal[j, i] for i in range(3)] for j in range(3)]
    if not program.right("nine_maps", "centre_map", "caster_map", "coverage", "share", "depths"):
        return _images_at_once(given, stacked([stacked(line) for line in at]), found)
    raster, view, results = program.map_raster(model.machine), program.light_view(program.centre), []
    for j, i in np.ndindex(3, 3):
        results.append(maps.allows(model, raster, program.caster_clip(at[j][i], view), found[j, i]))
        if given.refuted(results[-1][0]):
            results += [results[-1]] * (9 - len(results))
            break
    right, undecided, width = (np.stack(part).reshape(found.shape) for part in zip(*results, strict=True))
    return judgement(
        "maps",
        "texel",
        ["maps.image"],
        [right],
        width,
        replayed=fed("shadows", ["maps.image"], given.handed),
        undecided=undecided,
    )


def _images_at_once(given: Inputs, positions: Number, found: Floats) -> Judgement:
    """All nine by what a program makes of drawn ones: everything that a texel may be, and what lies between."""
    legal = given.model.bounded(given.model.program.nine_maps(positions))
    return judgement(
        "maps",
        "texel",
        ["maps.image"],
        [legal.allows(found)],
        2.0 * legal.error,
        replayed=fed("shadows", ["maps.image"], given.handed),
        undecided=2.0 * legal.error > maps.VISIBLE,
    )


def controls(given: Inputs) -> Judgement | None:
    """The control points as they were given."""
    found = given.own("controls", sampled=False)
    if found is None or not given.warps:
        return None
    bound = given.model.bounded(given.given_controls)
    right = np.asarray(bound.allows(found).all(axis=-1))
    return judgement("controls", "control point", ["controls"], [right], 2.0 * bound.error.max(axis=-1))


def spots(given: Inputs) -> Judgement | None:
    """Cell and fraction together, axis by axis."""
    cells, fractions = given.own("warp.cell"), given.own("warp.fraction")
    own = {name: a for name, a in (("warp.cell", cells), ("warp.fraction", fractions)) if a is not None}
    if not own or not given.warps:
        return None
    right = {name: np.zeros((given.count, 2), np.bool_) for name in own}
    together, undecided, width = np.zeros((given.count, 2), np.bool_), np.zeros((given.count, 2), np.bool_), []
    for sample, k in np.ndindex(given.count, 2):
        legal = places.located(given.model, given.lines[k], given.offset_seen(sample)[k])
        for place in legal:
            agrees = {
                "warp.cell": cells is None or bool(cells[sample, k] == place.cell),
                "warp.fraction": fractions is None or bool(place.fraction.allows(fractions[sample, k])),
            }
            for name in own:
                right[name][sample, k] |= agrees[name]
            together[sample, k] |= all(agrees.values())
        undecided[sample, k] = len(legal) > 1
        width.append(2.0 * float(legal[0].fraction.error))
    shape = np.shape(given.handed[next(iter(own))])
    return judgement(
        "warp",
        "place",
        list(own),
        [right[name].reshape(shape) for name in own],
        np.array(width).reshape(shape),
        replayed=fed("shadows", own, given.handed),
        undecided=undecided.reshape(shape),
        together=together.reshape(shape),
    )


def depths(given: Inputs) -> Judgement | None:
    """The caster's depths in the nine maps."""
    found = given.own("maps.depths", sampled=False)
    if found is None or not given.projective:
        return None
    bound, feeds = given.model.bounded(given.made_depths), fed("shadows", ["maps.depths"], given.handed)
    return judgement("maps", "map", ["maps.depths"], [bound.allows(found)], 2.0 * bound.error, replayed=feeds)


def shares(given: Inputs) -> Judgement | None:
    """The projective fractions."""
    found = given.own("warp.shares")
    if found is None or not given.projective:
        return None
    feeds = fed("shadows", ["warp.shares"], given.handed)
    compared = _compared(given, found, lambda s, p: stacked(given.made_shares(p)), feeds)
    return _judged(given, "share", "warp.shares", *compared, feeds)


def row_grids(given: Inputs) -> Judgement | None:
    """The grids of the two rows."""
    return _points(given, "warp.row_grids", lambda s, p: stacked(given.made_row_grids(s, p)))


def rows(given: Inputs) -> Judgement | None:
    """The two rows."""
    return _texels(given, "warp.rows", lambda s, p: stacked(given.made_rows(s, p)))


def grids(given: Inputs) -> Judgement | None:
    """The grid of the object's place."""
    return _points(given, "warp.grid", given.made_grid)


def warped(given: Inputs) -> Judgement | None:
    """The map of each sample: warped, as it is rendered, or from a grid."""
    if given.warps:
        return _texels(given, "warp.image", given.made_image)
    found = given.own("warp.image")
    if found is None:
        return None
    program, model, shape = given.model.program, given.model, np.shape(given.handed["warp.image"])
    if not given.direct or not program.right(*RENDERED):
        legal = [model.bounded(program.sample_map(place)) for place in program.places]
        right = np.stack([bound.allows(image) for bound, image in zip(legal, found, strict=True)]).reshape(shape)
        width = np.stack([2.0 * bound.error for bound in legal]).reshape(shape)
        return judgement("warp", "texel", ["warp.image"], [right], width, undecided=width > maps.VISIBLE)
    raster = program.direct_raster(model.machine)
    clips = [program.sample_clip(place) for place in program.places]
    results = [maps.allows(model, raster, clip, image) for clip, image in zip(clips, found, strict=True)]
    right, undecided, width = (np.stack(part).reshape(shape) for part in zip(*results, strict=True))
    return judgement("warp", "texel", ["warp.image"], [right], width, undecided=undecided)


def _points(given: Inputs, name: str, make: Callable[[int, Spot], Number]) -> Judgement | None:
    found = given.own(name)
    if found is None or not given.warps:
        return None
    feeds = fed("shadows", [name], given.handed)
    right, width = _compared(given, found, make, feeds)
    return _judged(given, "control point", name, np.asarray(right.all(axis=-1)), width.max(axis=-1), feeds)


def _texels(given: Inputs, name: str, make: Callable[[int, Spot], Number]) -> Judgement | None:
    found = given.own(name)
    if found is None or not given.warps:
        return None
    feeds = fed("shadows", [name], given.handed)
    return _judged(given, "texel", name, *_compared(given, found, make, feeds), feeds)


def _compared(
    given: Inputs, found: Floats, make: Callable[[int, Spot], Number], feeds: Sequence[str]
) -> tuple[Bools, Floats]:
    """For each sample at the place that agrees with most of what the port has; all right where its inputs are no numbers."""
    right, width = [], []
    for sample in range(given.count):
        options: list[Bounded] = [given.model.bounded(make(sample, spot)) for spot in given.places(sample)]
        agree = [option.allows(found[sample]) for option in options]
        best = max(range(len(options)), key=lambda i: int(agree[i].sum()))
        right.append(agree[best] | given.spoiled(sample, feeds))
        width.append(np.broadcast_to(2.0 * options[best].error, agree[best].shape))
        if given.refuted(right[-1]):
            rest = given.count - len(right)
            right, width = right + right[-1:] * rest, width + width[-1:] * rest
            break
    return np.stack(right), np.stack(width)


def _judged(given: Inputs, element: str, name: str, right: Bools, width: Floats, feeds: Sequence[str]) -> Judgement:
    if given.count == 1:
        right, width = right[0], width[0]
    return judgement("warp", element, [name], [right], width, replayed=feeds)
