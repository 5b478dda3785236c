"""How a judgement is put together from what each array says of each element."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.judgement import Judgement


def judgement(
    stage: str,
    element: str,
    bad: dict[str, Bools],
    undecided: Bools,
    width: Floats,
    replayed: tuple[str, ...] = (),
    places: Ints | None = None,
) -> Judgement:
    """bad: for each array that was compared, in order, where no legal outcome that agrees with those before has it."""
    blame = np.full(undecided.shape, -1, np.int8)
    for i, wrong in reversed(list(enumerate(bad.values()))):
        blame[wrong] = i
    return Judgement(
        stage=stage,
        element=element,
        arrays=tuple(bad),
        replayed=replayed,
        wrong=blame >= 0,
        undecided=undecided,
        width=width,
        blame=blame,
        places=places,
    )
