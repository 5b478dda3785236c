"""Replay of the stages maps, controls and warp."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.accept.bounded import Bounded, stored, uploaded
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.referees.reads import fed
from ibr_ref.oracle.referees.shadows import maps, places
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.judging import judgement, stacked
from ibr_ref.oracle.referees.shadows.places import Place

Spot = tuple[Place, Place]


def positions(given: Inputs) -> Judgement | None:
    """Where the object stands in the nine maps."""
    found = given.own("maps.positions", sampled=False)
    if found is None or given.direct:
        return None
    x, y = places.positions(given.case, given.device)
    right = np.ones((3, 3), np.bool_)
    for i in range(3):
        right[:, i] &= x[i].allows(found[:, i, 0])
        right[i, :] &= y[i].allows(found[i, :, 1])
    width = np.array([[2.0 * max(float(a.error), float(b.error)) for a in x] for b in y])
    return judgement("maps", "map", ["maps.positions"], [right], width)


def images(given: Inputs) -> Judgement | None:
    """The nine maps, at the port's own positions."""
    found = given.own("maps.image", sampled=False)
    if found is None or given.direct:
        return None
    own = given.own("maps.positions", sampled=False)
    x, y = places.positions(given.case, given.device)
    results = []
    for j, i in np.ndindex(3, 3):
        usable = own is not None and np.isfinite(own[j, i]).all()
        at = [x[i], y[j]]
        if own is not None and usable:
            at = [stored(n, given.device, legal) for n, legal in zip(own[j, i], at, strict=True)]
        results.append(maps.allows(given.case, given.centre_lens, at, found[j, i]))
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


def controls(given: Inputs) -> Judgement | None:
    """The control points as they were given."""
    found = given.own("controls", sampled=False)
    if found is None or given.direct:
        return None
    bound = uploaded(given.reference("controls", sampled=False), given.device)
    right = np.asarray(bound.allows(found).all(axis=-1))
    return judgement("controls", "control point", ["controls"], [right], 2.0 * bound.error.max(axis=-1))


def spots(given: Inputs) -> Judgement | None:
    """Cell and fraction together, axis by axis."""
    cells, fractions = given.own("warp.cell"), given.own("warp.fraction")
    own = {name: a for name, a in (("warp.cell", cells), ("warp.fraction", fractions)) if a is not None}
    if not own or given.direct:
        return None
    right = {name: np.zeros((given.count, 2), np.bool_) for name in own}
    together, undecided, width = np.zeros((given.count, 2), np.bool_), np.zeros((given.count, 2), np.bool_), []
    for sample, k in np.ndindex(given.count, 2):
        legal = places.located(given.lines[k], given.offset_seen(sample)[k])
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
    bound, feeds = given.made_depths, fed("shadows", ["maps.depths"], given.handed)
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
    """The map of each sample; method="direct": as it is rendered."""
    if not given.direct:
        return _texels(given, "warp.image", given.made_image)
    found = given.own("warp.image")
    if found is None:
        return None
    at = places.offset(given.case, given.device)
    results = [maps.allows(given.case, lens, at, image) for lens, image in zip(given.lenses, found, strict=True)]
    shape = np.shape(given.handed["warp.image"])
    right, undecided, width = (np.stack(part).reshape(shape) for part in zip(*results, strict=True))
    return judgement("warp", "texel", ["warp.image"], [right], width, undecided=undecided)


def _points(given: Inputs, name: str, make: Callable[[int, Spot], Bounded]) -> Judgement | None:
    found = given.own(name)
    if found is None or given.direct:
        return None
    feeds = fed("shadows", [name], given.handed)
    right, width = _compared(given, found, make, feeds)
    return _judged(given, "control point", name, np.asarray(right.all(axis=-1)), width.max(axis=-1), feeds)


def _texels(given: Inputs, name: str, make: Callable[[int, Spot], Bounded]) -> Judgement | None:
    found = given.own(name)
    if found is None or given.direct:
        return None
    feeds = fed("shadows", [name], given.handed)
    return _judged(given, "texel", name, *_compared(given, found, make, feeds), feeds)


def _compared(
    given: Inputs, found: Floats, make: Callable[[int, Spot], Bounded], feeds: Sequence[str]
) -> tuple[Bools, Floats]:
    """For each sample at the place that agrees with most of what the port has; all right where its inputs are no numbers."""
    right, width = [], []
    for sample in range(given.count):
        options = [make(sample, place) for place in given.places(sample)]
        agree = [option.allows(found[sample]) for option in options]
        best = max(range(len(options)), key=lambda i: int(agree[i].sum()))
        right.append(agree[best] | given.spoiled(sample, feeds))
        width.append(np.broadcast_to(2.0 * options[best].error, agree[best].shape))
    return np.stack(right), np.stack(width)


def _judged(given: Inputs, element: str, name: str, right: Bools, width: Floats, feeds: Sequence[str]) -> Judgement:
    if given.count == 1:
        right, width = right[0], width[0]
    return judgement("warp", element, [name], [right], width, replayed=feeds)
