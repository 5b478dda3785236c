"""Triangles that reach behind the eye: planes set up in float32 from their snapped corners stay within their bounds."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.accept.borders import Piece
from ibr_ref.oracle.accept.whole import whole
from ibr_ref.oracle.declaration import device_of
from ibr_ref.oracle.device import PROFILES

SIZE = (112, 84)
DEVICE = device_of("vulkan,subpixel_bits=4")
NEAR = 0.1


def behind(random: np.random.Generator) -> np.ndarray:
    """(3, 4) clip coordinates of a triangle of which the first corner lies behind the eye."""
    w = np.array([-random.uniform(0.05, 3.0), *random.uniform(0.5, 5.0, 2)])
    x, y = random.uniform(-3.0, 3.0, (2, 3))
    return np.stack([x, y, 1.02 * w - NEAR, w], axis=1).astype(np.float32).astype(np.float64)


def pixels_of(clip: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centres of pixels that show it, and each one's exact share of every corner, in the window."""
    rows, columns = np.mgrid[: SIZE[1], : SIZE[0]]
    px, py = columns.ravel() + 0.5, rows.ravel() + 0.5
    ndc = np.stack([2.0 * px / SIZE[0] - 1.0, 1.0 - 2.0 * py / SIZE[1], np.ones(len(px))])
    mixed = np.linalg.solve(clip[:, [0, 1, 3]].T, ndc)  # a point of space, up to a factor: sum m_i (x, y, w)_i
    shown = (mixed > 0.0).all(axis=0) & (mixed.T @ clip[:, 2] > 0.0)
    return px[shown], py[shown], (mixed * clip[:, 3:]).T[shown]


def window_of(clip: np.ndarray, number: type) -> tuple[np.ndarray, np.ndarray]:
    x, y, w = (clip[:, k].astype(number) for k in (0, 1, 3))
    one, half = number(1.0), np.array(SIZE).astype(number) / number(2.0)
    return (x * (one / w) + one) * half[0], (one - y * (one / w)) * half[1]


def float_planes(clip: np.ndarray, values: np.ndarray, px: np.ndarray, py: np.ndarray) -> np.ndarray:
    """(n, K) as SwiftShader has them: float32 planes of (3, K) over w, of snapped corners, from that of the largest w on."""
    order = np.roll(np.arange(3), -int(np.argmax(clip[:, 3])))
    x, y = (np.rint(axis * np.float32(16.0)) / np.float32(16.0) for axis in window_of(clip[order], np.float32))
    f = (values[order].astype(np.float32) * (np.float32(1.0) / clip[order, 3].astype(np.float32))[:, None]).astype(
        np.float32
    )
    ux, uy, vx, vy = x[1] - x[0], y[1] - y[0], x[2] - x[0], y[2] - y[0]
    over = np.float32(1.0) / (ux * vy - uy * vx)
    du, dv = f[1] - f[0], f[2] - f[0]
    along, down = (du * vy - dv * uy) * over, (dv * ux - du * vx) * over
    ways = (a.astype(np.float32)[:, None] - start for a, start in ((px, x[0]), (py, y[0])))
    return np.asarray(f[0] + along * next(ways) + down * next(ways), np.float64)


@pytest.mark.parametrize("seed", range(20))
def test_float32_planes_stay_within_their_bounds(seed: int) -> None:
    """Three varyings over w, and 1 / w. The exact plane moves by its gradient times the places' bound, besides roundings."""
    random = np.random.default_rng(seed)
    clip = behind(random)
    px, py, shares = pixels_of(clip)
    while len(px) < 20:
        clip = behind(random)
        px, py, shares = pixels_of(clip)
    assert shares.min() < 0.0, "the picture is beyond the corners"
    values = np.column_stack([random.uniform(0.0, 1.0, (3, 3)), np.ones(3)])
    over_w = values / clip[:, 3:]
    x, y = window_of(clip, np.float64)
    found = whole(clip, np.zeros_like(clip), SIZE, DEVICE)
    assert found is not None
    (piece,) = found.pieces((x, y), px, py, DEVICE)
    off = np.abs(float_planes(clip, values, px, py) - shares @ over_w)
    moves = np.linalg.solve(np.column_stack([x, y, np.ones(3)]), over_w)[:2]
    bound = piece.off(over_w) + np.abs(moves).sum(axis=0) * np.asarray(piece.moved)[:, None]
    assert (off <= bound).all()
    assert (off / bound).max() > 0.02, "the bounds say little"


def test_a_step_of_the_raster_weighs_more_behind_the_eye() -> None:
    """By as much as the shares say, which the step itself may make somewhat larger."""
    clip = np.array([(-2.0, -1.0, -1.0, -1.0), (3.0, 0.0, 3.0, 4.0), (0.0, -2.0, 2.0, 3.0)])
    px, py, shares = pixels_of(clip)
    (piece,) = _pieces(clip, px, py)
    weighed = np.abs(shares).sum(axis=1) * 2.0**-4
    assert weighed.max() > 1.5 * 2.0**-4
    assert (weighed <= piece.moved).all()
    assert (np.asarray(piece.moved) <= 1.25 * weighed + 1.0 / 256.0).all()


def _pieces(clip: np.ndarray, px: np.ndarray, py: np.ndarray) -> list[Piece]:
    found = whole(clip, np.zeros_like(clip), SIZE, DEVICE)
    assert found is not None
    return [*found.pieces(window_of(clip, np.float64), px, py, DEVICE)]


def test_a_corner_that_may_lie_in_the_eyes_plane_has_no_place() -> None:
    clip = np.array([(-2.0, -1.0, -1.0, 1e-9), (3.0, 0.0, 3.0, 4.0), (0.0, -2.0, 2.0, 3.0)])
    assert whole(clip, np.full(clip.shape, 1e-6), SIZE, DEVICE) is None


def test_who_grants_it() -> None:
    assert {name for name, device in PROFILES.items() if device.whole} == {"vulkan", "webgpu", "gl"}
    assert not device_of("gl,setup=clipped").whole
    assert device_of("ieee32,setup=whole").whole
