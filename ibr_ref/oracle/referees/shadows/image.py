"""The final picture from the case alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.shadows import resolve
from ibr_ref.oracle.referees.shadows.branches import Branches, branches, spread
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.judging import judgement
from ibr_ref.oracle.referees.shadows.model import Model
from ibr_ref.oracle.referees.shadows.project import shadow
from ibr_ref.oracle.referees.shadows.surface import Seen


@dataclass(frozen=True, eq=False)
class Accepted:
    """Everything that a picture may show."""

    model: Model
    seen: Seen
    outcomes: Branches
    color: list[Bounded]
    undecided: Bools
    """(H W,)."""
    width: Floats

    @classmethod
    def of(cls, alone: Inputs) -> Accepted:
        """alone: a case with nothing handed in."""
        model, seen = alone.model, alone.seen
        places = [alone.coordinate(i) for i in range(alone.count)]
        outcomes = branches(model, seen, [shadow(model, alone.map(i), at, seen.caster) for i, at in enumerate(places)])
        color = resolve.colors(model, seen, outcomes.fragment, outcomes.turned, outcomes.shadow)
        return cls(model, seen, outcomes, color, *spread(model, seen, outcomes, color))

    def judge(self, given: Handed) -> Judgement:
        """Depth and colour: each by itself, and one outcome for both."""
        seen, model, pixel = self.seen, self.model, self.seen.pixel[self.outcomes.fragment]
        shown, depth = (None if name not in given else np.asarray(given[name]) for name in ("color", "depth"))
        legal, nothing = {}, {}
        if depth is not None:
            legal["depth"] = seen.depth[self.outcomes.fragment].allows(depth.reshape(-1)[pixel])
            nothing["depth"] = resolve.allows_nothing(model, seen, None, depth)
        if shown is not None:
            read = resolve.as_read(model, seen, shown)
            legal["color"] = resolve.allows(self.color, read[pixel])
            nothing["color"] = resolve.allows_nothing(model, seen, read, None)
        crowded = np.zeros(len(seen.empty), np.bool_)
        crowded[seen.pixel[self.outcomes.crowded]] = True
        every = np.logical_and.reduce(list(legal.values())), np.logical_and.reduce(list(nothing.values()))
        return judgement(
            "image",
            "pixel",
            list(legal),
            [(seen.any_of(pixel, legal[name], nothing[name]) | crowded).reshape(seen.shape) for name in legal],
            self.width.reshape(seen.shape),
            undecided=(self.undecided | crowded | seen.wild).reshape(seen.shape),
            together=(seen.any_of(pixel, *every) | crowded).reshape(seen.shape),
        )
