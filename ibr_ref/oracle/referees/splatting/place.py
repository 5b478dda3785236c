"""Stage vertex in bounded numbers: where the points land, how wide they are, and whether they are kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.array_types import Bools
from ibr_ref.oracle.accept.bounded import Bounded, dot, exact, stored, total, uploaded
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed
from ibr_ref.oracle.referees.splatting.table import Table

Vector = Sequence[Bounded]


@dataclass(frozen=True, eq=False)
class Landed:
    """All points of a case in the window, (V,) each."""

    x: Bounded
    """Window, pixels; means nothing where the point is dropped. So do depth and width."""
    y: Bounded
    depth: Bounded
    width: Bounded
    """Clamped, pixels."""
    kept: Bools
    """Whether the reference keeps it."""
    doubtful: Bools
    """A legal device may decide otherwise."""

    @property
    def sure(self) -> Bools:
        """Kept by every legal device."""
        return self.kept & ~self.doubtful

    @property
    def possible(self) -> Bools:
        """Kept by some legal device."""
        return self.kept | self.doubtful


@dataclass(frozen=True, eq=False)
class Placed(Landed):
    """And how they came there."""

    world: list[Bounded]
    """x, y, z."""
    distance: Bounded
    """The law's d."""
    clip_z: Bounded
    clip_w: Bounded


def placed(case: Case, device: Device, points: Table) -> Placed:
    """Every point through unprojection, T_R->W, T_W->C and T_P."""
    world = world_points(case, device, points)
    camera = case.scene.camera
    view = transform(camera.view_from_world, world, device)[:3]
    clip = _clip(case, device, points, world, view)
    x, y = (clip[axis] / clip[3] for axis in (0, 1))
    one = exact(1.0, device)
    kept, doubtful = _kept(case, device, view, clip)
    distance = _distance(camera, world, view, device)
    return Placed(
        world=world,
        x=_window(x, x + one, camera.width),
        y=_window(y, one - y, camera.height),
        depth=_window_depth(case, device, view, clip),
        distance=distance,
        width=splat_width(case.params, distance),
        clip_z=clip[2],
        clip_w=clip[3],
        kept=kept,
        doubtful=doubtful,
    )


def transform(matrix: ArrayLike, point: Vector, device: Device) -> list[Bounded]:
    """The rows of a matrix (rows, 4) applied to points of w = 1."""
    return [_row(row, point, device) for row in np.asarray(matrix, np.float64)]


def _row(row: NDArray[np.float64], point: Vector, device: Device) -> Bounded:
    terms = [product for c, x in zip(row[:3], point, strict=True) for product in _products(float(c), x)]
    terms += _products(float(row[3]), exact(np.ones_like(point[0].value), device))
    return total(terms) if len(terms) > 1 else terms[0]


def _products(coefficient: float, x: Bounded) -> list[Bounded]:
    """coefficient x, as terms of a sum. Where the device rounds correctly, 0 x is no term, and 1 x is x."""
    if x.device.operation <= 1.0 and abs(coefficient) in (0.0, 1.0):
        return [] if coefficient == 0.0 else [x if coefficient > 0.0 else -x]
    return [uploaded(coefficient, x.device) * x]


def _clip(case: Case, device: Device, points: Table, world: Vector, view: Vector) -> list[Bounded]:
    """One matrix after another, as the conventions have it; or two or all three multiplied together on the host."""
    camera = case.scene.camera
    clip = transform(camera.clip_from_view, view, device)
    two = transform(camera.clip_from_world, world, device)
    parts = []
    for image, share in zip(case.scene.images, points.shares, strict=True):
        own = view_points(image.camera, points.columns[share], points.rows[share], points.depth[share])
        parts.append(transform(camera.clip_from_world @ image.camera.world_from_view, own, device))
    three = [joined([part[i] for part in parts]) for i in range(4)]
    return [either(*orders) for orders in zip(clip, two, three, strict=True)]


def either(first: Bounded, *others: Bounded) -> Bounded:
    """The same number by other formulas: the first one's value, and the largest error."""
    error = reduce(np.maximum, [other.error for other in (first, *others)])
    return Bounded(first.value, error, first.device)


def world_points(case: Case, device: Device, points: Table) -> list[Bounded]:
    """x, y, z (V,) of all points in world space."""
    parts = []
    for image, share in zip(case.scene.images, points.shares, strict=True):
        view = view_points(image.camera, points.columns[share], points.rows[share], points.depth[share])
        parts.append(transform(image.camera.world_from_view[:3], view, device))
    return [joined([part[axis] for part in parts]) for axis in range(3)]


def view_points(camera: Any, columns: ArrayLike, rows: ArrayLike, depth: Bounded) -> list[Bounded]:
    """x, y, z of the pixels' centres in the reference camera's view space."""
    device = depth.device
    (f_x, skew, c_x), (_, f_y, c_y), _ = np.asarray(camera.intrinsics, np.float64).tolist()
    u, v = (exact(np.asarray(index, np.float64) + 0.5, device) for index in (columns, rows))
    y = _over(v - uploaded(c_y, device), f_y)
    from_center = u - uploaded(c_x, device)
    x = _over(from_center if skew == 0.0 else total([u, -uploaded(c_x, device), -(uploaded(skew, device) * y)]), f_x)
    # Or by the inverse matrix, ((1/f_x, -s/(f_x f_y), ...), (0, 1/f_y, -c_y/f_y)), made on the host.
    x = either(x, _by_row((1.0 / f_x, -skew / (f_x * f_y), (skew * c_y / f_y - c_x) / f_x), u, v))
    y = either(y, _by_row((0.0, 1.0 / f_y, -c_y / f_y), u, v))
    if camera.perspective:
        x, y = x * depth, y * depth
    return [x, -y, -depth]


def _over(a: Bounded, b: float) -> Bounded:
    """a / b; or times 1 / b, rounded and uploaded, as ports do that divide by the same number for all points."""
    return either(a / uploaded(b, a.device), a * uploaded(1.0 / b, a.device))


def _by_row(row: tuple[float, float, float], u: Bounded, v: Bounded) -> Bounded:
    """A row of a (3, 3) matrix applied to (u, v, 1)."""
    terms = [term for a, b in zip(row, (u, v), strict=False) for term in _products(a, b)]
    return total([*terms, uploaded(row[2], u.device)])


def joined(parts: Sequence[Bounded]) -> Bounded:
    """One array of several."""
    values, errors = zip(*(np.broadcast_arrays(part.value, part.error) for part in parts), strict=True)
    return Bounded(np.concatenate(values), np.concatenate(errors), parts[0].device)


def _window(ndc: Bounded, from_border: Bounded, size: int) -> Bounded:
    """from_border / 2 . size, as the conventions have it; or ndc . size / 2 + size / 2, as viewports do."""
    device = ndc.device
    scaled, half = from_border * exact(0.5 * size, device), exact(0.5 * size, device)
    viewport = total([ndc * half, exact(np.full_like(ndc.value, 0.5 * size), device)])
    value = from_border.value / 2.0 * float(size)
    return either(Bounded(value, scaled.error, device), viewport)


def _minus_one(case: Case, device: Device, view: Vector, clip: Vector) -> Bounded:
    """Clip z of a port whose clip space starts at -w, 2 z - w by one matrix."""
    rows = np.asarray(case.scene.camera.clip_from_view, np.float64)
    return transform((2.0 * rows[2] - rows[3])[None], view, device)[0]


def _window_depth(case: Case, device: Device, view: Vector, clip: Vector) -> Bounded:
    depth = clip[2] / clip[3]
    if not device.minus_one:
        return depth
    half = exact(0.5, device)
    other = half * (_minus_one(case, device, view, clip) / clip[3]) + half
    return either(depth, other)


def _kept(case: Case, device: Device, view: Vector, clip: Vector) -> tuple[Bools, Bools]:
    """w > 0 and 0 <= z <= w: what the reference decides, and where rounding may decide otherwise."""
    z, w = clip[2], clip[3]
    off_near, off_far = z.error, z.error + w.error
    if device.minus_one:
        other = _minus_one(case, device, view, clip)
        # -w <= z' and z' <= w with z' = 2 z - w: twice as far from the planes as z is.
        off_near, off_far = (np.maximum(off, 0.5 * (other.error + w.error)) for off in (off_near, off_far))
    tests = [(w.value > 0.0, w.value, w.error), (z.value >= 0.0, z.value, off_near)]
    tests.append((z.value <= w.value, w.value - z.value, off_far))
    kept = np.logical_and.reduce([passed for passed, _, _ in tests])
    maybe = np.logical_and.reduce([passed | (np.abs(margin) <= off) for passed, margin, off in tests])
    surely = np.logical_and.reduce([passed & ((np.abs(margin) > off) | (off == 0.0)) for passed, margin, off in tests])
    return kept, maybe & ~surely


def _distance(camera: Any, world: Vector, view: Vector, device: Device) -> Bounded:
    """d: from the eye, or along the view axis of a camera that has none."""
    if not camera.perspective:
        return -view[2]
    away = [p - uploaded(e, device) for p, e in zip(world, np.asarray(camera.eye, np.float64)[:3], strict=True)]
    return dot(away, away).root()


def splat_width(params: Any, d: Bounded) -> Bounded:
    """alpha / (beta d^2 + gamma d + delta), clamped."""
    device = d.device
    terms = [*_products(params.beta, d * d), *_products(params.gamma, d)]
    terms.append(uploaded(np.full_like(d.value, params.delta), device))
    alpha = uploaded(params.alpha, device)
    width = alpha / total(terms) if len(terms) > 1 else correctly_rounded(alpha, terms[0])
    least, most = (uploaded(limit, device) for limit in (params.min_width, params.max_width))
    clamped = width.between(params.min_width, params.max_width)
    at_limit = np.where(width.low < params.min_width, least.error, 0.0)
    return clamped.widened(np.maximum(at_limit, np.where(width.high > params.max_width, most.error, 0.0)))


def correctly_rounded(a: Bounded, b: Bounded) -> Bounded:
    """a / b; exact where a, b and the quotient are floats and the device rounds correctly (IEEE 754-2019, 4.3)."""
    quotient = a / b
    floats = (a.error == 0.0) & (b.error == 0.0) & (quotient.value == quotient.value.astype(np.float32))
    return Bounded(quotient.value, np.where(floats & (a.device.quotient <= 1.0), 0.0, quotient.error), a.device)


LANDED = ("vertex.window", "vertex.depth", "vertex.width")
"""The port's arrays that a splat is made of."""


def landed(case: Case, device: Device, points: Table, handed: Handed) -> Landed:
    """The points as the port has them, where it handed them in, else as they are.

    A point is kept as the port's width says, or its window position; where these are NaN, it is not drawn.
    """
    fed = tuple(name for name in LANDED if name in handed)
    own = placed(case, device, points)
    if not fed:
        return own
    fields = {"x": own.x, "y": own.y, "depth": own.depth, "width": own.width}
    given = {name: np.asarray(handed[name], np.float64) for name in fed}
    kept = np.ones(len(points.rows), np.bool_)
    for array in given.values():
        kept &= np.isfinite(array.reshape(len(kept), -1)).all(axis=1)
    if "vertex.window" in fed:
        x, y = given["vertex.window"].T
        fields["x"], fields["y"] = stored(x, device, own.x), stored(y, device, own.y)
    if "vertex.depth" in fed:
        fields["depth"] = stored(given["vertex.depth"], device, own.depth)
    if "vertex.width" in fed:
        fields["width"] = stored(given["vertex.width"], device, own.width)
        kept &= given["vertex.width"] > 0.0
    return Landed(**fields, kept=kept, doubtful=np.zeros_like(kept))
