"""Where the light's samples are, where the object stands as each sees it, and where that is among the nine maps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.accept.bounded import Bounded, dot, exact, total, uploaded
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.referees.shadows.transform import Lens

STEP = 2.0 / 3.0
"""g: the light's samples are at the centres of cells three to an edge (shadows/method.md, "Light samples")."""


@dataclass(frozen=True, eq=False)
class Sample:
    """A sample of the light."""

    position: Floats
    """(3,)."""
    sizes: Floats
    """(3,) of the terms that it is the sum of: what their roundings are relative to."""
    displacement: list[Bounded]
    """x and y of position - centre along the offset axes."""


def count(case: Any) -> int:
    """How many samples there are."""
    given = case.params.light_samples
    return len(given) if isinstance(given, np.ndarray) else int(given)


def samples(case: Any, device: Device) -> list[Sample]:
    """In the order of the contract."""
    scene, params = case.scene, case.params
    centre, edges = (np.asarray(a, np.float64) for a in scene.light.arrays)
    axes = [[uploaded(n, device) for n in axis] for axis in np.asarray(scene.axes, np.float64)]
    if isinstance(params.light_samples, np.ndarray):
        given = np.asarray(params.light_samples, np.float64)
        moves = [[uploaded(n, device) - uploaded(c, device) for n, c in zip(p, centre, strict=True)] for p in given]
        return [Sample(p, np.abs(p), list(on_axes(axes, move))) for p, move in zip(given, moves, strict=True)]
    steps = {1: (), 5: (-STEP, STEP), 9: (-STEP, 0.0, STEP)}[int(params.light_samples)]
    result = []
    for g, h in [(0.0, 0.0), *((g, h) for h in steps for g in steps if (g, h) != (0.0, 0.0))]:
        # Where operations are correctly rounded the centre plus nothing is the centre.
        still = (g, h) == (0.0, 0.0) and device.operation <= 1.0
        move = [exact(0.0, device)] * 3 if still else _moved(g, h, edges, centre, device)
        sizes = np.abs(centre) + np.abs(g * edges[0]) + np.abs(h * edges[1])
        result.append(Sample(centre + (g * edges[0] + h * edges[1]), sizes, list(on_axes(axes, move))))
    return result


def _moved(g: float, h: float, edges: Floats, centre: Floats, device: Device) -> list[Bounded]:
    """position - centre, with the position's own roundings or without."""
    result = []
    for k in range(3):
        middle = uploaded(centre[k], device)
        place = middle + dot([uploaded(g, device), uploaded(h, device)], [uploaded(e, device) for e in edges[:, k]])
        difference = place - middle
        value = (centre[k] + (g * edges[0, k] + h * edges[1, k])) - centre[k]
        result.append(Bounded(np.asarray(value), difference.error, device))
    return result


def on_axes(axes: Sequence[Sequence[Bounded]], vector: Sequence[Bounded]) -> tuple[Bounded, Bounded]:
    """x and y of the point x a + y b next to a vector, by the axes' Gram matrix."""
    a, b = axes
    aa, ab, bb = dot(a, a), dot(a, b), dot(b, b)
    va, vb = dot(vector, a), dot(vector, b)
    determinant = aa * bb - ab * ab
    return (bb * va - ab * vb) / determinant, (aa * vb - ab * va) / determinant


def offset(case: Any, device: Device) -> list[Bounded]:
    """x and y of the object."""
    return [uploaded(o, device) for o in np.asarray(case.scene.offset, np.float64)]


@dataclass(frozen=True, eq=False)
class Place:
    """Along one axis: a cell of the positions that may hold the object, and its fraction in that."""

    cell: int
    fraction: Bounded


def located(lines: Bounded, at: Bounded) -> list[Place]:
    """The legal places on an axis with three positions, the reference's first: two where the middle line is too near."""
    low, middle, high = (lines[k] for k in range(3))
    away = at - middle
    cells = [int(at.value >= middle.value)]
    if abs(away.value) <= away.error:
        cells.append(1 - cells[0])
    ends = ((low, middle), (middle, high))
    return [Place(cell, (at - ends[cell][0]) / (ends[cell][1] - ends[cell][0])) for cell in cells]


def fraction_in(lines: Bounded, at: Bounded, cell: int) -> Bounded:
    """The fraction in a cell that the port has chosen."""
    ends = [lines[cell], lines[cell + 1]]
    return (at - ends[0]) / (ends[1] - ends[0])


def depths(case: Any, lens: Lens, lines: Sequence[Bounded]) -> Bounded:
    """(3, 3) of the middle of the caster's box along the light's view axis; lines: the three x and three y of the maps."""
    device, three = lines[0].device, np.arange(3)
    axes, ends = np.asarray(case.scene.axes, np.float64), np.asarray(case.scene.caster.bounds, np.float64)
    offset = [lines[0][np.tile(three, 3)], lines[1][np.repeat(three, 3)]]
    middle = []
    for k in range(3):
        box = (uploaded(ends[0, k], device) + uploaded(ends[1, k], device)) * exact(0.5, device)
        middle.append(total([box, *(o * uploaded(axis[k], device) for o, axis in zip(offset, axes, strict=True))]))
    w = lens.clip_of(middle)[3]
    return Bounded(w.value.reshape(3, 3), w.error.reshape(3, 3), device)


def paced(fraction: Bounded, w0: Bounded, w1: Bounded) -> Bounded:
    """Of the way in the maps, after a fraction of the way between two depths."""
    gone = fraction * w1
    return gone / ((exact(1.0, fraction.device) - fraction) * w0 + gone)


def positions(case: Any, device: Device) -> list[list[Bounded]]:
    """For x and y the three positions of the object in the nine maps."""
    scene = case.scene
    axes = [[uploaded(n, device) for n in axis] for axis in np.asarray(scene.axes, np.float64)]
    own = on_axes(axes, [uploaded(n, device) for n in scene.light.arrays[0]])
    ends = np.asarray(scene.offset_range, np.float64)
    result = []
    for k in range(2):
        moves = [sample.displacement[k] for sample in samples(case, device)]
        widest = np.max([abs(m.value) for m in moves])
        error = np.max([m.error for m in moves])
        widening = Bounded(np.asarray(widest), np.asarray(error), device)
        low, high = uploaded(ends[k, 0], device) - widening, uploaded(ends[k, 1], device) + widening
        result.append([low, _middle(low, high, own[k]), high])
    return result


def _middle(low: Bounded, high: Bounded, own: Bounded) -> Bounded:
    """The light's own coordinate; the range's middle where it falls on an end, or perhaps either."""
    halfway = (low + high) * exact(0.5, low.device)
    inside = low.value < own.value < high.value
    chosen = own if inside else halfway
    if min(abs(own.value - low.value), abs(own.value - high.value)) > own.error + low.error + high.error:
        return chosen
    return chosen.widened(abs(own.value - halfway.value) + own.error + halfway.error)
