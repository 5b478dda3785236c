"""Stage normals: 8-bit codes by interval, with every choice of neighbours that rounding may make.

The decisions: whether a neighbour is across a jump, which of two is the nearer one, on which side the camera is, and whether
the cross product is zero. A code may be the neighbour where 127 n + 128.5 is within its bound of a whole number.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.accept.bounded import Bounded, dot, exact, total, unit, uploaded
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.splatting.place import transform, view_points
from ibr_ref.oracle.referees.splatting.table import cut_out
from ibr_ref.oracle.referees.splatting.verdict import judgement

JUMP = 0.05
"""Neighbours farther apart than this share of the depth lie on different surfaces (splatting/method.md, "Stage normals")."""

CHOICES = (1, -1, 0)
"""Along an axis: the neighbour right or below, left or above, or none."""


@dataclass(frozen=True, eq=False)
class Surface:
    """An image's pixels as points: (H, W) each."""

    valid: Bools
    depth: Bounded
    world: list[Bounded]
    eye: list[Bounded]
    """From the point to the reference camera, or the direction to it."""


@dataclass(frozen=True, eq=False)
class Steps:
    """Along one axis of an image, (H, W) each: which choices of a neighbour are legal, and which is the reference's."""

    legal: dict[int, Bools]
    reference: Ints


def judge(case: Case, device: Device, handed: Handed) -> Judgement:
    """All texels of all images, in order, as one row of elements."""
    parts = [_judge_image(case, device, handed, i) for i in range(len(case.scene.images))]
    wrong, undecided, width = (np.concatenate([part[k].reshape(-1) for part in parts]) for k in range(3))
    places = np.concatenate([part[3] for part in parts])
    return judgement("normals", "texel", {"atlas.normal": wrong}, undecided, width, places=places)


def _judge_image(case: Case, device: Device, handed: Handed, image: int) -> tuple[NDArray[Any], ...]:
    legal = Codes(surface(case.scene.images[image], device))
    wrong, rect = read(case, handed, image, legal)
    rows, columns = np.indices(wrong.shape)
    places = np.stack([np.full_like(rows, rect[0]), rows + rect[2], columns + rect[1]], axis=2).reshape(-1, 3)
    return wrong, legal.undecided, legal.width, places


def read(case: Case, handed: Handed, image: int, legal: Codes) -> tuple[Bools, Ints]:
    """(H, W) which codes of an image are wrong, and the rectangle that they are read from: the port's if that is better.

    Where the port put the image in its atlas is another stage's matter.
    """
    rects = np.asarray(case.frame.stages["atlas.rects"], np.int64)
    best, where = legal.surface.valid.copy(), rects[image]
    for places in [rects, *([np.asarray(handed["atlas.rects"], np.int64)] if "atlas.rects" in handed else [])]:
        codes = cut_out(handed["atlas.normal"], places[image])
        if codes is not None and codes.shape == (*legal.surface.valid.shape, 3):
            wrong = ~legal.allows(codes.astype(np.float64)) & ~_overwritten(places, image)
            if places is rects or wrong.sum() < best.sum():
                best, where = wrong, places[image]
    return best, where


def _overwritten(rects: Ints, image: int) -> Bools:
    """(H, W) texels of an image that lie in another one's rectangle too: whose normal is there, nobody can tell."""
    page, x, y, width, height = rects[image].tolist()
    result = np.zeros((height, width), np.bool_)
    for other in np.flatnonzero((rects[:, 0] == page) & (np.arange(len(rects)) != image)):
        _, left, top, across, down = rects[other].tolist()
        rows = slice(max(top - y, 0), max(top + down - y, 0))
        result[rows, max(left - x, 0) : max(left + across - x, 0)] = True
    return result


def surface(image: Any, device: Device) -> Surface:
    """The points of an image; off the mask at depth 1, where they mean nothing."""
    _, depth, mask = image.arrays
    camera = image.camera
    bounded = uploaded(np.where(mask, depth, 1.0), device)
    rows, columns = np.indices(depth.shape)
    world = transform(camera.world_from_view[:3], view_points(camera, columns, rows, bounded), device)
    x, y, z, w = np.asarray(camera.eye, np.float64).tolist()
    if w == 0.0:
        eye = [uploaded(np.full(depth.shape, a), device) for a in (x, y, z)]
    else:
        eye = [uploaded(a, device) - p for a, p in zip((x, y, z), world, strict=True)]
    return Surface(mask, bounded, world, eye)


def steps(surface: Surface, axis: int) -> Steps:
    """Right or left (axis 1), below or above (axis 0)."""
    device = surface.depth.device
    limit = uploaded(JUMP, device) * surface.depth
    sizes, usable, maybe = {}, {}, {}
    for side in (1, -1):
        there = _shifted(surface.valid, axis, side, False) & surface.valid
        values, errors = (_shifted(a, axis, side, 0.0) for a in (surface.depth.value, surface.depth.error))
        other = Bounded(values, errors, device)
        size = _difference(other, surface.depth).absolute()
        margin, off = limit.value - size.value, limit.error + size.error
        sizes[side], usable[side] = size, there & (margin >= 0.0)
        maybe[side] = there & (margin >= -off), there & (margin >= off)
    after, before = sizes[1], sizes[-1]
    first, off = after.value <= before.value, after.error + before.error
    close = (np.abs(after.value - before.value) <= off) & (off > 0.0) & ~_same(surface.depth.value, surface.valid, axis)
    (after_maybe, after_sure), (before_maybe, before_sure) = maybe[1], maybe[-1]
    legal = {
        1: after_maybe & (~before_sure | first | close),
        -1: before_maybe & (~after_sure | ~first | close),
        0: ~after_sure & ~before_sure,
    }
    takes_after = usable[1] & (~usable[-1] | first)
    return Steps(legal, np.where(takes_after, 1, np.where(usable[-1], -1, 0)))


def _same(depth: NDArray[np.float64], valid: Bools, axis: int) -> Bools:
    """Both neighbours have one depth: their distances are made of the same numbers, and tie on every device."""
    after, before = (_shifted(np.where(valid, depth, np.nan), axis, side, np.nan) for side in (1, -1))
    return np.asarray(after == before)


def _difference(a: Bounded, b: Bounded) -> Bounded:
    """a - b; exact where all three are floats and the device rounds correctly (IEEE 754-2019, 4.3): ties are ties."""
    result = a - b
    floats = (a.error == 0.0) & (b.error == 0.0) & (result.value == result.value.astype(np.float32))
    return Bounded(result.value, np.where(floats & (a.device.operation <= 1.0), 0.0, result.error), a.device)


def _shifted(array: NDArray[Any], axis: int, side: int, outside: Any) -> NDArray[Any]:
    """Each pixel's neighbour on a side of an axis."""
    result = np.full_like(array, outside)
    here, there = [slice(None)] * 2, [slice(None)] * 2
    here[axis], there[axis] = (slice(None, -1), slice(1, None)) if side > 0 else (slice(1, None), slice(None, -1))
    result[tuple(here)] = array[tuple(there)]
    return result


class Codes:
    """The legal codes of an image's pixels."""

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        across, along = steps(surface, 1), steps(surface, 0)
        self.across, self.along = across, along
        shape = surface.valid.shape
        self.low, self.high = np.zeros((2, *shape, 3))
        self.outcomes: list[tuple[Ints, NDArray[np.float64], NDArray[np.float64]]] = []
        """Pixels (n, 2), and the least and largest code (n, 3) of one outcome of all decisions."""
        self._none(surface.valid & (across.legal[0] | along.legal[0]))
        for a in (1, -1):
            for b in (1, -1):
                self._pair(np.argwhere(surface.valid & across.legal[a] & along.legal[b]), a, b)
        self.width, self.undecided = self._spread()

    def allows(self, codes: NDArray[np.float64]) -> Bools:
        """(H, W) whether the three codes of a pixel agree with one outcome; off the mask they are 0."""
        agrees = ~self.surface.valid & (codes == 0.0).all(axis=2)
        for pixels, low, high in self.outcomes:
            found = codes[pixels[:, 0], pixels[:, 1]]
            fits = pixels[((low <= found) & (found <= high)).all(axis=1)]
            agrees[fits[:, 0], fits[:, 1]] = True
        return np.asarray(agrees, np.bool_)

    def _at(self, vector: list[Bounded], pixels: Ints) -> list[Bounded]:
        return [a[pixels[:, 0], pixels[:, 1]] for a in vector]

    def _none(self, where: Bools) -> None:
        """Without a pair: towards the camera."""
        pixels = np.argwhere(where)
        self._outcome(pixels, unit(self._at(self.surface.eye, pixels)))

    def _pair(self, pixels: Ints, a: int, b: int) -> None:
        """The cross product of the steps to the neighbour a on the row and b in the column, facing the camera."""
        here, eye = self._at(self.surface.world, pixels), self._at(self.surface.eye, pixels)
        p, q = (
            [other - own for other, own in zip(self._at(self.surface.world, pixels + step), here, strict=True)]
            for step in ([0, a], [b, 0])
        )
        normal = [dot([p[i], -p[j]], [q[j], q[i]]) for i, j in ((1, 2), (2, 0), (0, 1))]
        vague = np.logical_and.reduce([np.abs(n.value) <= n.error for n in normal])
        if vague.any():
            # The product may be zero, or have any direction.
            anything = np.zeros((int(vague.sum()), 3))
            self.outcomes.append((pixels[vague], anything + 1.0, anything + 255.0))
        pixels, normal, eye = pixels[~vague], [n[~vague] for n in normal], [e[~vague] for e in eye]
        direction = unit(normal)
        facing = dot(direction, eye)
        doubtful = np.abs(facing.value) <= facing.error
        away = facing.value < 0.0
        for turned, where in ((False, ~away | doubtful), (True, away | doubtful)):
            self._outcome(pixels[where], [-n[where] if turned else n[where] for n in direction])

    def _outcome(self, pixels: Ints, normal: list[Bounded]) -> None:
        if not len(pixels):
            return
        device = normal[0].device
        codes = [
            total([exact(127.0, device) * n, exact(np.full_like(n.value, 128.5), device)]).between(1.0, 255.5)
            for n in normal
        ]
        low, high = (np.stack([np.floor(getattr(code, end)) for code in codes], 1) for end in ("low", "high"))
        self.outcomes.append((pixels, low, high))

    def _spread(self) -> tuple[NDArray[np.float64], Bools]:
        """Of each pixel: width of its widest outcome, and whether two differ by more than one code."""
        shape = self.surface.valid.shape
        width = np.full(shape, np.nan)
        least, most = np.full((*shape, 3), np.inf), np.full((*shape, 3), -np.inf)
        for pixels, low, high in self.outcomes:
            at = (pixels[:, 0], pixels[:, 1])
            width[at] = np.fmax(width[at], (high - low).max(axis=1))
            least[at], most[at] = np.minimum(least[at], low), np.maximum(most[at], high)
        return width, np.asarray(self.surface.valid & ((most - least).max(axis=2) > 1.0))
