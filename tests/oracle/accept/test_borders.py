"""Pieces that are left at the picture's borders: planes set up in float32 over any of them stay within their bounds."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.accept import borders
from ibr_ref.oracle.declaration import device_of
from ibr_ref.oracle.device import PROFILES

SIZE = (112, 84)
ROUNDED = PROFILES["webgpu"]


def clip_of(window: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Clip coordinates (n, 4) of places in the window."""
    ndc = np.stack([2.0 * window[:, 0] / SIZE[0] - 1.0, 1.0 - 2.0 * window[:, 1] / SIZE[1]], axis=1)
    return np.column_stack([ndc * w[:, None], 0.5 * w, w])


def cut(window: np.ndarray, w: np.ndarray | None = None) -> borders.Cut | None:
    clip = clip_of(window, np.ones(len(window)) if w is None else w)
    return borders.cut(clip, np.zeros_like(clip), SIZE, ROUNDED)


def test_what_is_left_of_a_triangle() -> None:
    inside = np.array([(0.5, 10.0), (100.0, 20.0), (50.0, 80.0)])
    assert cut(inside) is None
    assert cut(inside + np.array([200.0, 0.0])) is None, "all of it is beside the picture"
    left = cut(inside - np.array([1.5, 0.0]))
    assert left is not None
    # x = 0 cuts the edges from (-1, 10) a part 1 / 99.5 and 1 / 49.5 along.
    expected = {(0.0, 10.0 + 10.0 / 99.5), (0.0, 10.0 + 70.0 / 49.5), (98.5, 20.0), (48.5, 80.0)}
    found = {*zip(left.x.round(9).tolist(), left.y.round(9).tolist(), strict=True)}
    assert found == {(x, round(y, 9)) for x, y in expected}
    assert (left.crossings, left.moved < 1e-3) == (1, True)


def float_planes(x: np.ndarray, y: np.ndarray, values: np.ndarray, px: np.ndarray, py: np.ndarray) -> np.ndarray:
    """(n, K) as llvmpipe has it: float32 planes of (3, K), anchored at the first corner and evaluated from (0, 0)."""
    x, y, values, px, py = (np.asarray(a, np.float32) for a in (x, y, values, px, py))
    ux, uy, vx, vy = x[1] - x[0], y[1] - y[0], x[2] - x[0], y[2] - y[0]
    over = np.float32(1.0) / (ux * vy - uy * vx)
    du, dv = values[1] - values[0], values[2] - values[0]
    along, down = (du * vy - dv * uy) * over, (dv * ux - du * vx) * over
    start = values[0] - (along * x[0] + down * y[0])
    return np.asarray(start + along * px[:, None] + down * py[:, None], np.float64)


@pytest.mark.parametrize("seed", range(20))
def test_float32_planes_of_any_piece_stay_within_their_bounds(seed: int) -> None:
    """Triangles with a corner up to a pixel beside the picture; three varyings over w, and 1 / w."""
    random = np.random.default_rng(seed)
    window = random.uniform((5.0, 5.0), (107.0, 79.0), (3, 2))
    window[0, 0] = -(10.0 ** random.uniform(-2.0, 0.0))
    w = random.uniform(1.0, 3.0, 3)
    left = cut(window, w)
    assert left is not None
    planes = np.column_stack([random.uniform(0.0, 1.0, (3, 3)), np.ones(3)]) / w[:, None]
    rows, columns = np.mgrid[: SIZE[1], : SIZE[0]]
    px, py = columns.ravel() + 0.5, rows.ravel() + 0.5
    worst = 0.0
    for piece in left.pieces((window[:, 0], window[:, 1]), px, py, ROUNDED):
        at = piece.shares @ np.column_stack([window, planes])
        points = px[piece.points], py[piece.points]
        shares = borders.weights(window[:, 0], window[:, 1], *points)
        off = np.abs(float_planes(at[:, 0], at[:, 1], at[:, 2:], *points) - shares @ planes)
        bound = piece.off(planes)
        assert (off <= bound).all()
        worst = max(worst, float((off / bound).max()))
    assert worst > 0.005, "the bounds say little"


def test_wide_pieces_are_hardly_wider() -> None:
    """A triangle that reaches far out: no piece is a sliver, and all are as sure as single floats are."""
    window = np.array([(-40.0, 10.0), (100.0, 20.0), (50.0, 80.0)])
    left = cut(window)
    assert left is not None
    px, py = np.array([50.5]), np.array([40.5])
    found = [*left.pieces((window[:, 0], window[:, 1]), px, py, ROUNDED)]
    assert found
    assert max(float(piece.off(np.eye(3)).max()) for piece in found) < 1e-4
    assert all(piece.moved < 1.0 / 200.0 for piece in found)


def test_devices_with_a_guard_band_cut_nothing() -> None:
    assert not device_of("gl,clip_border=none").clip_border
    assert {name for name, device in PROFILES.items() if device.clip_border} == {"vulkan", "webgpu", "gl"}
