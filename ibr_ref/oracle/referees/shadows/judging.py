"""How a stage's elements become a judgement."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.judgement import Judgement


def judgement(
    stage: str,
    element: str,
    arrays: Sequence[str],
    right: Sequence[Bools],
    width: Floats,
    *,
    replayed: Sequence[str] = (),
    undecided: Bools | None = None,
    together: Bools | None = None,
) -> Judgement:
    """right: of each of the arrays whether it is, by itself; together: whether one outcome agrees with all of them."""
    legal = np.logical_and.reduce(list(right)) if together is None else together
    blame = np.full(legal.shape, len(arrays) - 1, np.int8)
    for i in reversed(range(len(arrays))):
        blame[~right[i]] = i
    blame[legal] = -1
    return Judgement(
        stage=stage,
        element=element,
        arrays=tuple(arrays),
        replayed=tuple(replayed),
        wrong=~legal,
        undecided=np.zeros(legal.shape, np.bool_) if undecided is None else undecided,
        width=np.broadcast_to(width, legal.shape).copy(),
        blame=blame,
        part=arrays[0] if stage in ("maps", "warp") else "",
    )
