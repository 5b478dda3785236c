"""Triangles that the near or the far plane may cut, one by one: there are few.

Where a plane cuts an edge, at the share t of its way, is uncertain by what the distances' roundings make of t. Near the eye
that may be many pixels, but all along the edge: the polygon's other edges, and what is interpolated, stay what they are. So
that a corner may slide is only told where the new edge, along the plane, can be seen.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Floats, Ints
from ibr_ref.oracle.accept import borders
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.coverage import RASTER
from ibr_ref.oracle.accept.whole import Whole, whole
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.programs.shadows.raster import FAR, NEAR

CROSSING_ROUNDINGS = 5.0
"""Of a (1 - t) + b t, each relative to the larger of a and b: 1 - t, two products, a sum; one of the result."""


@dataclass(frozen=True, eq=False)
class Corner:
    """A corner of a polygon: clip coordinates and attributes with their errors, and the point that it is."""

    value: Floats
    error: Floats
    slide: Floats
    """By how much more the corner may move along the edge that it was cut from."""
    name: int
    plane: int = -1
    """That made it."""


@dataclass(frozen=True, eq=False)
class Cut:
    """Triangles (T, 3) after clipping."""

    x: Bounded
    """In the window."""
    y: Bounded
    z: Bounded
    """Window depth."""
    w: Bounded
    """Clip w, > 0."""
    attributes: list[Bounded]
    names: Ints
    """One number for corners that are one point."""
    source: Ints
    """(T,) growing: the triangle before clipping."""
    setups: list[list[borders.Cut | Whole]]
    """Of each triangle, what else its planes may be set up over: what the picture's borders leave of its polygon, where
    the device may cut it there; the triangle before it was clipped, where it may be set up so."""
    wild: bool
    """Of some triangle it is not certain whether or where a plane cuts it: it may cover anything."""


Window = Callable[[Sequence[Bounded]], list[Bounded]]
"""Window x, y and depth of clip coordinates x, y, z, w."""


def clipped(
    numbers: Sequence[Bounded],
    triangles: NDArray[np.integer],
    names: Ints,
    size: tuple[int, int],
    window: Window,
    planes: Sequence[int] = (NEAR, FAR),
) -> Cut:
    """Clip triangles (T, 3) of vertices (V,) whose numbers are x, y, z, w and attributes; names (V,) of points."""
    device = numbers[0].device
    value = np.stack([n.value for n in numbers], axis=-1)[triangles]
    error = np.stack([np.broadcast_to(n.error, n.value.shape) for n in numbers], axis=-1)[triangles]
    near, far, slack = value[..., 2], value[..., 3] - value[..., 2], error[..., 2] + error[..., 3]
    if NEAR not in planes:
        near = np.full(near.shape, np.inf)
    kept = ((near > error[..., 2]) & (far > slack)).all(axis=1)
    gone = (near < -error[..., 2]).all(axis=1) | (far < -slack).all(axis=1)
    unclear = ((np.abs(near) <= error[..., 2]) | (np.abs(far) <= slack)).any(axis=1) & ~gone
    fresh = _Names(int(names.max(initial=0)) + 1)
    pieces: list[tuple[int, tuple[Corner, Corner, Corner]]] = []
    wild = bool(unclear.any())
    for t in np.flatnonzero(~kept & ~gone & ~unclear):
        still = np.zeros(value.shape[2])
        polygon = [Corner(value[t, i], error[t, i], still, int(names[triangles[t, i]])) for i in range(3)]
        for plane in planes:
            polygon = _cut(polygon, plane, fresh, device)
        if _slides_into_view(polygon, size, window, device):
            polygon = [replace(c, error=c.error + c.slide, slide=still) for c in polygon]
            wild |= not all(np.isfinite(c.error).all() for c in polygon)
        pieces += [(int(t), fan) for fan in _fan(polygon)]
    source = np.concatenate([np.flatnonzero(kept), np.array([t for t, _ in pieces], np.int64)])
    order = np.argsort(source, kind="stable")
    shape = (-1, 3, value.shape[2])
    joined = [
        np.concatenate([a[kept], np.reshape([[getattr(c, n) for c in fan] for _, fan in pieces], shape)])[order]
        for a, n in ((value, "value"), (error, "error"), (np.zeros_like(value), "slide"))
    ]
    cut_names = np.reshape([[c.name for c in fan] for _, fan in pieces], (-1, 3)).astype(np.int64)
    named = np.concatenate([names[triangles[kept]], cut_names])[order]
    parts = [Bounded(joined[0][..., k], joined[1][..., k], device) for k in range(shape[2])]
    x, y, z = window(parts[:4])
    # A corner that slides is snapped from elsewhere on its edge: it leaves the edge by up to half a step either way.
    off = np.where(joined[2].any(axis=2), 1.0 / RASTER, 0.0)
    cuts = _borders(joined[0], joined[1], source[order], size, device)
    off += np.array([[0.0 if each is None else each.moved] for each in cuts]).reshape(-1, 1)
    own = {int(t): whole(value[t, :, :4], error[t, :, :4], size, device) for t, _ in pieces if device.whole}
    setups = [
        [s for s in (cut, own.get(t)) if s is not None] for t, cut in zip(source[order].tolist(), cuts, strict=True)
    ]
    return Cut(x.widened(off), y.widened(off), z, parts[3], parts[4:], named, source[order], setups, wild)


def _borders(
    value: Floats, error: Floats, source: Ints, size: tuple[int, int], device: Device
) -> list[borders.Cut | None]:
    """Of each triangle (T, 3) the cut of the polygon that it is of: the fan of its source."""
    result: list[borders.Cut | None] = [None] * len(source)
    if not device.clip_border:
        return result
    with np.errstate(invalid="ignore"):
        outside = np.flatnonzero((np.abs(value[..., :2]) > value[..., 3:4]).any(axis=(1, 2)))
    for each in np.unique(source[outside]):
        fan = range(*np.searchsorted(source, [each, each + 1]))
        clip, off = (np.concatenate([a[fan[0], :, :4], *(a[t, 2:, :4] for t in fan[1:])]) for a in (value, error))
        found = borders.cut(clip, off, size, device)
        for t in fan:
            result[t] = found
    return result


class _Names:
    """Numbers for new points: one for each edge and plane."""

    def __init__(self, first: int) -> None:
        self._first = first
        self._known: dict[tuple[int, int, int], int] = {}

    def of(self, a: int, b: int, plane: int) -> int:
        return self._known.setdefault((min(a, b), max(a, b), plane), self._first + len(self._known))


def _distance(corner: Corner, plane: int) -> tuple[float, float]:
    """From the near (0) or the far plane (1), >= 0 inside, and its error."""
    z, w = corner.value[2], corner.value[3]
    off_z, off_w = (corner.error + corner.slide)[2:4]
    return (z, off_z) if plane == 0 else (w - z, off_z + off_w + UNIT * abs(w - z))


def _cut(polygon: list[Corner], plane: int, fresh: _Names, device: Device) -> list[Corner]:
    """One Sutherland-Hodgman step."""
    result = []
    for here, there in zip(polygon, [*polygon[1:], *polygon[:1]], strict=True):
        kept, next_kept = (_distance(c, plane)[0] >= 0.0 for c in (here, there))
        if kept:
            result.append(here)
        if kept != next_kept:
            result.append(_crossing(*((here, there) if kept else (there, here)), plane, fresh, device))
    return result


def _crossing(inside: Corner, outside: Corner, plane: int, fresh: _Names, device: Device) -> Corner:
    """t = i / (i - o); each of the distances moves it by no more than its error over the least i - o."""
    (i, off_i), (o, off_o) = _distance(inside, plane), _distance(outside, plane)
    t = i / (i - o)
    room = i - o - off_i - off_o
    off = ((1.0 - t) * off_i + t * off_o) / room + 2.0 * device.quotient * UNIT if room > 0.0 else np.inf
    value = inside.value * (1.0 - t) + outside.value * t
    size = np.maximum(np.abs(inside.value), np.abs(outside.value))
    error = np.maximum(inside.error, outside.error) + CROSSING_ROUNDINGS * device.operation * UNIT * size
    slide = np.abs(outside.value - inside.value) * off + np.maximum(inside.slide, outside.slide)
    return Corner(value, error, slide, fresh.of(inside.name, outside.name, plane), plane)


def _slides_into_view(polygon: list[Corner], size: tuple[int, int], window: Window, device: Device) -> bool:
    """Whether an edge along a plane may cross the picture, if its corners slide."""
    boxes = {}
    for i, corner in enumerate(polygon):
        if corner.plane >= 0:
            moved = [Bounded(corner.value[k], corner.error[k] + corner.slide[k], device) for k in range(4)]
            boxes[i] = window(moved)[:2]
    for i, (x, y) in boxes.items():
        j = (i + 1) % len(polygon)
        if j not in boxes or polygon[i].plane != polygon[j].plane:
            continue
        other_x, other_y = boxes[j]
        beside = [
            max(a.high, b.high) < 0.0 or min(a.low, b.low) > n
            for a, b, n in ((x, other_x, float(size[0])), (y, other_y, float(size[1])))
        ]
        if not any(beside):
            return True
    return False


def _fan(polygon: list[Corner]) -> list[tuple[Corner, Corner, Corner]]:
    return [(polygon[0], polygon[k], polygon[k + 1]) for k in range(1, len(polygon) - 1)]
