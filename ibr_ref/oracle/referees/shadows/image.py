"""The final picture from the case alone."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.shadows import resolve
from ibr_ref.oracle.referees.shadows.branches import Branches, branches, spread
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.judging import judgement
from ibr_ref.oracle.referees.shadows.project import coordinate, shadow
from ibr_ref.oracle.referees.shadows.surface import Seen


def judge(case: Any, device: Device, given: Handed) -> Judgement:
    """Colour, and depth where it is handed in."""
    made = Inputs(case, device)
    seen = made.seen
    shadows = [
        shadow(case, made.map(i), coordinate(lens, seen.world), seen.caster) for i, lens in enumerate(made.lenses)
    ]
    found = branches(case, seen, shadows)
    color = resolve.colors(case.scene, seen, found.fragment, found.turned, found.shadow)
    return _judged(case, seen, found, color, given)


def _judged(case: Any, seen: Seen, found: Branches, color: list[Bounded], given: Handed) -> Judgement:
    """Each array by itself, and one outcome for both."""
    pixel, scene = seen.pixel[found.fragment], case.scene
    shown, depth = (None if name not in given else np.asarray(given[name]) for name in ("color", "depth"))
    legal, nothing = {}, {}
    if shown is not None:
        legal["color"] = resolve.allows(color, shown.reshape(-1, 3)[pixel])
        nothing["color"] = resolve.allows_nothing(scene, seen, shown, None)
    if depth is not None:
        legal["depth"] = seen.depth[found.fragment].allows(depth.reshape(-1)[pixel])
        nothing["depth"] = resolve.allows_nothing(scene, seen, None, depth)
    crowded = np.zeros(len(seen.empty), np.bool_)
    crowded[seen.pixel[found.crowded]] = True
    every = np.logical_and.reduce(list(legal.values())), np.logical_and.reduce(list(nothing.values()))
    undecided, width = spread(case, seen, found, color)
    return judgement(
        "image",
        "pixel",
        list(legal),
        [(seen.any_of(pixel, legal[name], nothing[name]) | crowded).reshape(seen.shape) for name in legal],
        width.reshape(seen.shape),
        undecided=(undecided | crowded | seen.wild).reshape(seen.shape),
        together=(seen.any_of(pixel, *every) | crowded).reshape(seen.shape),
    )
