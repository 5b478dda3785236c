"""Replay of what is drawn with the camera: depth, project, accumulate and resolve.

The contract has no array of what the camera sees: every fragment that may be shown is followed. Where the port has handed in
its depth, only those that agree with it, or all where none does, which is the depth's fault.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.accept.bounded import converted, stored
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.referees.reads import fed
from ibr_ref.oracle.referees.shadows import replay_soft, resolve
from ibr_ref.oracle.referees.shadows.accumulate import accumulated, in_bytes
from ibr_ref.oracle.referees.shadows.branches import Branches, branches, in_shadow, spread
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.judging import judgement
from ibr_ref.oracle.referees.shadows.maps import VISIBLE
from ibr_ref.oracle.referees.shadows.project import Shadow, handed, shadow

_WARPED = ("maps.", "controls", "warp.")


def depth(given: Inputs) -> Judgement | None:
    """Which surface is seen, by its depth."""
    own = given.own("depth", sampled=False)
    if own is None:
        return None
    seen = given.seen
    flat = own.reshape(-1)
    right = seen.any_of(seen.pixel, seen.depth.allows(flat[seen.pixel]), flat == 1.0)
    width, least, most = np.zeros(flat.size), np.where(seen.empty, 1.0, np.inf), np.where(seen.empty, 1.0, -np.inf)
    np.maximum.at(width, seen.pixel, 2.0 * seen.depth.error)
    np.minimum.at(least, seen.pixel, seen.depth.low)
    np.maximum.at(most, seen.pixel, seen.depth.high)
    undecided = (most - least > width + VISIBLE) | seen.wild
    shape = seen.shape
    arrays = right.reshape(shape), width.reshape(shape), undecided.reshape(shape)
    return judgement("depth", "pixel", ["depth"], [arrays[0]], arrays[1], undecided=arrays[2])


def _agreeing(given: Inputs) -> tuple[Bools, Bools]:
    """(n,) fragments that a port's depth leaves, and (H W,) pixels that it leaves empty."""
    seen, own = given.seen, given.own("depth", sampled=False)
    if own is None:
        return np.ones(len(seen.pixel), np.bool_), np.ones(len(seen.empty), np.bool_)
    flat = own.reshape(-1)
    legal = seen.depth.allows(flat[seen.pixel])
    right = seen.any_of(seen.pixel, legal, flat == 1.0)
    return legal | ~right[seen.pixel], (flat == 1.0) | ~right


def projected(given: Inputs) -> Judgement | None:
    """Coordinates and shadows of all samples together, for each fragment that a pixel may show."""
    soft = given.model.program.soft
    names = [
        name for name in (replay_soft.NAMES if soft else ("project.coord", "project.shadow")) if name in given.handed
    ]
    if not names:
        return None
    agreement = replay_soft.agreement if soft else _agreement
    legal, nothing, undecided, width = agreement(given, names, *_agreeing(given))
    names, seen = [*legal], given.seen
    right = [seen.any_of(seen.pixel, legal[name], nothing[name]).reshape(seen.shape) for name in names]
    every = [np.logical_and.reduce([each[name] for name in names]) for each in (legal, nothing)]
    return judgement(
        "project",
        "pixel",
        names,
        right,
        width.reshape(seen.shape),
        replayed=_fed(given, *names),
        undecided=undecided.reshape(seen.shape),
        together=seen.any_of(seen.pixel, *every).reshape(seen.shape),
    )


def _agreement(given: Inputs, names: list[str], fragments: Bools, bare: Bools) -> replay_soft.Agreement:
    """By the maps of all samples."""
    coords, found = given.own("project.coord"), given.own("project.shadow")
    seen, pixel = given.seen, given.seen.pixel
    legal, nothing = {name: fragments.copy() for name in names}, {name: bare.copy() for name in names}
    undecided, width = seen.wild.copy(), np.zeros(len(seen.empty))
    for i in range(given.count):
        at = given.coordinate(i)
        if coords is not None:
            own = coords[i].reshape(-1, 3)
            nothing["project.coord"] &= (own == 0.0).all(axis=1)
            for k, axis in enumerate(at.axes):
                legal["project.coord"] &= axis.allows(own[pixel, k])
                np.maximum.at(width, pixel, 2.0 * axis.error)
            if given.refuted(seen.any_of(pixel, legal["project.coord"], nothing["project.coord"])):
                break
            at = handed(own[pixel], at)
        if found is not None:
            flat = found[i].reshape(-1)
            nothing["project.shadow"] &= flat == 0.0
            shadows = shadow(given.model, given.map(i), at, seen.caster)
            legal["project.shadow"] &= shadows.allows(flat[pixel])
            undecided[pixel[_differs(shadows)]] = True
            if given.refuted(seen.any_of(pixel, legal["project.shadow"], nothing["project.shadow"])):
                break
            np.maximum.at(width, pixel, 2.0 * np.broadcast_to(shadows.first.error, pixel.shape))
    return replay_soft.Agreement(legal, nothing, undecided, width)


def _differs(legal: Shadow) -> Bools:
    out = (legal.first.low - legal.other.low > VISIBLE) | (legal.other.high - legal.first.high > VISIBLE)
    return np.asarray(legal.open & out)


def sums(given: Inputs) -> Judgement | None:
    """The sum of the port's own shadows, or of what they may be."""
    if "accumulate.shadow" not in given.handed:
        return None
    found = np.asarray(given.handed["accumulate.shadow"]).astype(np.float64)
    own, name = given.own("project.shadow"), "accumulate.shadow"
    if own is not None:
        shadows = [stored(_numbers(s), given.device) for s in own]
        bound = accumulated(given.model, shadows)
        # What is no number is wrong before.
        right = (bound.allows(found) & _stored(given, found)) | ~np.isfinite(own).all(axis=0)
        width = np.broadcast_to(2.0 * bound.error, found.shape)
        return judgement("accumulate", "pixel", [name], [right], width, replayed=_fed(given, name))
    seen, outcomes = given.seen, _outcomes(given)
    pixel = seen.pixel[outcomes.fragment]
    fragments, nothing = _agreeing(given)
    legal = outcomes.shadow.allows(found.reshape(-1)[pixel]) & fragments[outcomes.fragment]
    right = seen.any_of(pixel, legal, nothing & (found.reshape(-1) == 0.0))
    right[seen.pixel[outcomes.crowded]] = True
    right &= _stored(given, found).reshape(-1)
    width = np.zeros(found.size)
    np.maximum.at(width, pixel, 2.0 * np.broadcast_to(outcomes.shadow.error, pixel.shape))
    feeds = _fed(given, name)
    return judgement(
        "accumulate", "pixel", [name], [right.reshape(seen.shape)], width.reshape(seen.shape), replayed=feeds
    )


def _stored(given: Inputs, found: Floats) -> Bools:
    """Whether sums may be what the accumulation's buffer holds."""
    if given.case.params.accumulation == "unorm8":
        return in_bytes(found, given.device)
    return np.isfinite(found)


def _fed(given: Inputs, *names: str) -> tuple[str, ...]:
    """The port's arrays that some are computed from; method="direct" warps nothing."""
    found = fed("shadows", names, given.handed)
    return tuple(name for name in found if given.warps or name == "warp.image" or not name.startswith(_WARPED))


def _numbers(array: Floats) -> Floats:
    """A port's array with 0 for what is no number: such elements are skipped."""
    return np.where(np.isfinite(array), array, 0.0)


def _outcomes(given: Inputs) -> Branches:
    """What the sum may be, from the port's own shadows or coordinates if it has handed them in."""
    seen, own = given.seen, given.own("project.shadow")
    if own is not None:
        shadows = [stored(_numbers(s).reshape(-1)[seen.pixel], given.device) for s in own]
        return in_shadow(seen, accumulated(given.model, shadows))
    coords, outcomes = given.own("project.coord"), []
    for i in range(given.count):
        at = given.coordinate(i)
        if coords is not None:
            at = handed(coords[i].reshape(-1, 3)[seen.pixel], at)
        outcomes.append(shadow(given.model, given.map(i), at, seen.caster))
    return branches(given.model, seen, outcomes)


def colors(given: Inputs) -> Judgement | None:
    """Colour, in the port's own shadow."""
    if "color" not in given.handed:
        return None
    seen, model, own = given.seen, given.model, given.own("accumulate.shadow", sampled=False)
    if own is not None:
        read = converted if given.case.params.accumulation == "unorm8" else stored
        outcomes = in_shadow(seen, read(_numbers(own).reshape(-1)[seen.pixel], given.device))
    else:
        outcomes = _outcomes(given)
    color = resolve.colors(model, seen, outcomes.fragment, outcomes.turned, outcomes.shadow)
    pixel, shown = seen.pixel[outcomes.fragment], resolve.as_read(model, seen, np.asarray(given.handed["color"]))
    fragments, nothing = _agreeing(given)
    legal = resolve.allows(color, shown[pixel]) & fragments[outcomes.fragment]
    right = seen.any_of(pixel, legal, nothing & resolve.allows_nothing(model, seen, shown, None))
    right[seen.pixel[outcomes.crowded]] = True
    if own is not None:
        right |= ~np.isfinite(own.reshape(-1))
    undecided, width = spread(model, seen, outcomes, color)
    return judgement(
        "resolve",
        "pixel",
        ["color"],
        [right.reshape(seen.shape)],
        width.reshape(seen.shape),
        replayed=_fed(given, "color"),
        undecided=(undecided | seen.wild).reshape(seen.shape),
    )
