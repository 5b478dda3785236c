"""A closed surface has no holes: whatever the snapping, one of two triangles covers what lies on their common edge."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.coverage import fragments
from ibr_ref.oracle.accept.seams import loose, owners
from ibr_ref.oracle.arithmetic.device import Arithmetic, Policy
from ibr_ref.oracle.device import IEEE32, VULKAN, Device
from tests.oracle.accept.test_bounds import _inside

SIZE, CELLS = 40, 9


def sheet(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """(V, 2) points of a net with moved knots, and its triangles."""
    knots = np.stack(np.meshgrid(np.linspace(1, 39, CELLS + 1), np.linspace(1, 39, CELLS + 1)), axis=-1).reshape(-1, 2)
    knots += np.random.default_rng(seed).uniform(-1.5, 1.5, knots.shape)
    corner = (np.arange(CELLS)[:, None] * (CELLS + 1) + np.arange(CELLS)).reshape(-1, 1)
    cells = corner + np.array([0, 1, CELLS + 2, 0, CELLS + 2, CELLS + 1])
    return knots, cells.reshape(-1, 3)


@pytest.mark.parametrize(("device", "rounding"), [(IEEE32, "even"), (VULKAN, "up"), (VULKAN, "down")])
def test_one_of_a_pair_is_drawn(device: Device, rounding: str) -> None:
    points, triangles = sheet(3)
    off = 2e-3
    bounds = [Bounded(points[triangles, k], np.full(triangles.shape, off), device) for k in (0, 1)]
    found = fragments(*bounds, SIZE, SIZE)
    paired = owners(found, triangles, SIZE)
    assert (paired.drawn & ~found.certain).sum() > 10
    arithmetic = Arithmetic(Policy(subpixel_rounding=rounding))
    random = np.random.default_rng(5)
    for _ in range(20):
        moved = arithmetic.snap(points + random.uniform(-off, off, points.shape))
        inside = np.stack([_inside(moved[t], SIZE, SIZE) for t in triangles])
        drawn = inside[found.triangle, found.rows, found.columns]
        count = np.bincount(paired.owner, drawn, len(drawn))
        assert (count[paired.owner[paired.drawn]] == 1).all()


def test_a_border_is_not_a_seam() -> None:
    """Of a fold both triangles lie on one side of their common edge: what is on it may be of neither."""
    points = np.array([(2.0, 20.5), (30.0, 20.5), (16.0, 30.0), (16.0, 35.0)])
    triangles = np.array([(0, 1, 2), (0, 1, 3)])
    bounds = [Bounded(points[triangles, k], np.full(triangles.shape, 1e-3), VULKAN) for k in (0, 1)]
    found = fragments(*bounds, SIZE, SIZE)
    on_edge = (found.rows == 20) & ~found.certain
    assert on_edge.any()
    assert not owners(found, triangles, SIZE).drawn[on_edge].any()


@pytest.mark.parametrize("seed", range(4))
def test_beside_a_strip_thinner_than_its_corners_are_known(seed: int) -> None:
    """What the edge of two triangles leaves open one of both has, but for pixels that lie beyond the other, a thin one."""
    random = np.random.default_rng(seed)
    lower = np.stack([np.linspace(2.0, 37.0, 4), 20.0 + random.uniform(-4.0, 4.0, 4)], axis=1)
    upper = lower + np.stack([np.zeros(4), random.uniform(0.0, 0.1, 4)], axis=1)
    points = np.concatenate([lower, upper, upper + np.array([0.0, 6.0])])
    cells = np.concatenate([np.arange(3), np.arange(4, 7)])[:, None] + np.array([0, 1, 5, 0, 5, 4])
    triangles, off = cells.reshape(-1, 3), np.repeat([0.02, 0.4, 0.02], 4)
    corners = [Bounded(points[triangles, k], off[triangles], VULKAN) for k in (0, 1)]
    found = fragments(corners[0], corners[1], SIZE, SIZE)
    pixel = found.rows * SIZE + found.columns
    doubtful = np.zeros(SIZE * SIZE, np.bool_)
    doubtful[pixel[loose(found, pixel, triangles, np.ones(len(triangles), np.bool_))]] = True
    certain = ~doubtful[pixel]
    assert 0 < certain.sum() < len(certain)
    arithmetic = Arithmetic(Policy(subpixel_rounding="down"))
    for _ in range(40):
        moved = arithmetic.snap(points + off[:, None] * random.choice([-1.0, 1.0], points.shape))
        inside = np.any([_inside(moved[t], SIZE, SIZE) for t in triangles], axis=0).reshape(-1)
        assert inside[pixel[certain]].all()
