"""Which value a number of the case has in a port: the plain program is drawn with others until its results are the port's.

In double precision, at some elements; what is found is not judged here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ibr_ref.array_types import Bools, Floats

Draw = Callable[[float], Floats | None]
"""Results with a value, in a row; None where it is not allowed, or there are others in number."""
VectorDraw = Callable[[Floats], Floats | None]
"""The same with a vector (3,)."""

TURNS, EARLY = 8, 2
"""Of Newton's method at most; and after how many a number must have come nearer."""
PROMISED, REACHED = 0.9, 0.2
"""What a first step must promise to leave of the differences, and of how many of them at least."""
STEP = 2.0**-16
"""Of its difference quotients, relative: some thousand times what rounding leaves of doubles' results."""
SMALL = 2.0**-6
"""Size of a number that is 0."""
SETTLED = 2.0**-30
"""Relative: below what floats resolve."""
SENSITIVE = 1e-2
"""Of the largest derivative: what depends on a number less says nothing of it."""
NEARER, MOST_LEFT = 0.5, 0.05
"""Of what differed, what is left early and at last: where there is more it is another fault."""
DOUBLINGS, HALVINGS = 8, 16
"""Of a bound that results jump at; few jump between the last two."""
HALVED = 4
"""Times that a step which leads out of what is allowed, or nowhere, is halved."""
DIGITS = 9
"""Those of a float32."""


def fitted(start: float, first: Floats, draw: Draw, target: Floats, slack: Floats, *, jumps: bool) -> list[float]:
    """What explains the target, rounded to one digit, two and so on; nothing where no value does.

    first: (n,) results with the value that it starts from. target, slack: (n,) a port's, and how far they may be from the
    plain ones. jumps: results do, at a bound.
    """
    if first.shape != target.shape:
        return []
    value = (_bounded if jumps else _smooth)(start, first, draw, target, slack)
    return [] if value is None else [*dict.fromkeys(float(f"{value:.{n}g}") for n in range(1, DIGITS + 1))]


def _smooth(start: float, first: Floats, draw: Draw, target: Floats, slack: Floats) -> float | None:
    """Newton's method; each step is the one that most elements ask for."""
    x, here = start, first
    for turn in range(TURNS):
        slopes = _slopes(x, here, draw)
        if slopes is None:
            return None
        used = np.isfinite(target - here) & (np.abs(slopes) > SENSITIVE * np.nanmax(np.abs(slopes), initial=0.0))
        off = used & (np.abs(target - first) > slack)
        if not off.any():
            return None
        move = _middle((target - here)[used] / slopes[used], np.abs(slopes[used]))
        if not turn and _hopeless(target - here, slack, off, move * slopes):
            return None
        moved = _moved(x, move, draw)
        if moved is None:
            return None
        x, here = moved
        settled = abs(move) <= SETTLED * max(abs(x), SMALL)
        left = np.median(np.abs(target - here)[off] / np.abs(target - first)[off])
        if turn >= EARLY and not left < NEARER:
            return None
        if settled or turn == TURNS - 1:
            return x if left < MOST_LEFT else None
    return None


def fitted_vector(start: Floats, draw: VectorDraw, target: Floats, slack: Floats) -> list[Floats]:
    """(3,) what explains the target, rounded to one digit, two and so on; nothing where no vector does.

    By Gauss and Newton; what is far off, beside shadows' borders, counts little.
    """
    x, here = np.asarray(start, np.float64), draw(start)
    if here is None or here.shape != target.shape:
        return []
    off = np.isfinite(target - here) & (np.abs(target - here) > slack)
    if not off.any():  # what differs is no number anywhere
        return []
    before = np.abs(target - here)[off]
    for turn in range(TURNS):
        moved = _stepped(x, here, draw, target, slack)
        if moved is None:  # as near as results of floats lead
            break
        x, here = moved
        if turn >= EARLY and not np.median(np.abs(target - here)[off] / before) < NEARER:
            return []
    if not np.median(np.abs(target - here)[off] / before) < MOST_LEFT:
        return []
    rounded = (tuple(float(f"{c:.{n}g}") for c in _cleaned(x, n)) for n in range(1, DIGITS + 1))
    return [np.array(each) for each in dict.fromkeys(rounded)]


def _cleaned(x: Floats, digits: int) -> Floats:
    """A component that is nothing beside the largest is 0."""
    return np.where(np.abs(x) < 10.0**-digits * np.abs(x).max(), 0.0, x)


def _stepped(x: Floats, here: Floats, draw: VectorDraw, target: Floats, slack: Floats) -> tuple[Floats, Floats] | None:
    """The step that the differences ask for, as far as it comes nearer."""
    size = STEP * max(np.abs(x).max(), SMALL)
    moved = [draw(x + size * axis) for axis in np.eye(3)]
    if any(there is None or there.shape != here.shape for there in moved):
        return None
    slopes = np.stack([(there - here) / size for there in moved if there is not None], axis=1)
    apart = target - here
    used = np.isfinite(apart) & np.isfinite(slopes).all(axis=1) & (slopes != 0.0).any(axis=1)
    if np.count_nonzero(used) < x.size:
        return None
    scale = np.median(np.abs(apart[used])) + np.median(slack[used])
    weight = 1.0 / (1.0 + (apart[used] / scale) ** 2)
    matrix = slopes[used].T * weight
    normal, wanted = matrix @ slopes[used], matrix @ apart[used]
    if not (np.isfinite(normal).all() and np.isfinite(wanted).all()):  # a port's numbers may be anything
        return None
    step, *_ = np.linalg.lstsq(normal, wanted, rcond=None)
    for halved in range(HALVED):
        there = draw(x + step / 2**halved)
        if there is not None and np.median(np.abs(target - there)[used]) <= np.median(np.abs(apart)[used]):
            return x + step / 2**halved, there
    return None


def _hopeless(apart: Floats, slack: Floats, off: Bools, change: Floats) -> bool:
    """Whether much of what differs hangs on something else, or a first step comes no nearer."""
    if np.count_nonzero(off) < REACHED * np.count_nonzero(np.abs(apart) > slack):
        return True
    return not np.median(np.abs(apart - change)[off] / np.abs(apart)[off]) < PROMISED


def _slopes(x: float, here: Floats, draw: Draw) -> Floats | None:
    """Difference quotients, of whichever side is allowed."""
    size = STEP * max(abs(x), SMALL)
    for step in (size, -size):
        there = draw(x + step)
        if there is not None and there.shape == here.shape:
            return (there - here) / step
    return None


def _moved(x: float, move: float, draw: Draw) -> tuple[float, Floats] | None:
    """A step as far as it is allowed."""
    for halved in range(HALVED):
        there = draw(x + move / 2**halved)
        if there is not None:
            return x + move / 2**halved, there
    return None


def _middle(values: Floats, weights: Floats) -> float:
    """The weighted median."""
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, 0.5 * total[-1])])


def _bounded(start: float, first: Floats, draw: Draw, target: Floats, slack: Floats) -> float | None:
    """Bisection between values that leave too much and too little; the middle of those that leave the least."""
    for other in _bracket(start):
        there = draw(other)
        if there is None:
            continue
        # Of what jumps on the way; elsewhere plain results may fall on the other side of something else.
        some = np.abs(there - first) > slack
        sign = np.sign((first - target)[some].sum())
        if sign * (there - target)[some].sum() < 0.0:
            break
    else:
        return None

    def excess(x: float) -> Floats:
        found = draw(x)
        return np.full(some.sum(), np.inf) if found is None else (found - target)[some]

    def apart(off: Floats) -> int:
        return int(np.count_nonzero(np.abs(off) > slack[some]))

    x = _edge(start, other, lambda at: bool(excess(at).sum() * sign > 0.0))
    least = apart(excess(x))
    if least > MOST_LEFT * apart((first - target)[some]):
        return None
    return 0.5 * sum(_edge(end, x, lambda at: apart(excess(at)) > least) for end in (start, other))


def _bracket(start: float) -> Iterator[float]:
    """Values farther and farther off, upwards, and down to 0."""
    size = abs(start) or SMALL
    yield from (start + size * (2.0**k - 1.0) for k in range(1, DOUBLINGS))
    yield from (start - size * (1.0 - 2.0**-k) for k in range(1, DOUBLINGS))
    yield start - size


def _edge(out: float, inside: float, outside: Callable[[float], bool]) -> float:
    """The value next to the border between a value that is outside and one that may be inside."""
    for _ in range(HALVINGS):
        middle = 0.5 * (out + inside)
        if outside(middle):
            out = middle
        else:
            inside = middle
    return inside
