"""The bounds hold what devices do: random policies never leave the sets of `accept`."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from ibr_ref.oracle.accept.bounded import Bounded, dot, exact, lerp, opposite, power, unit, uploaded
from ibr_ref.oracle.accept.coverage import Fragments, fragments, snapped
from ibr_ref.oracle.accept.fetch import Texture, fetch, highest_around
from ibr_ref.oracle.accept.winners import winners
from ibr_ref.oracle.arithmetic.device import Arithmetic, Policy
from ibr_ref.oracle.device import GL, IEEE32, PROFILES, VULKAN, Device
from ibr_ref.pipeline.clip import clip_triangles
from ibr_ref.pipeline.triangles import set_up

POLICIES = [
    (IEEE32, Policy()),
    (IEEE32, Policy(backwards=True)),
    (IEEE32, Policy(fused=True)),
    (VULKAN, Policy(reciprocal=True, weight_bits=8, weight_rounding="down")),
    (GL, Policy(jitter=2, seed=1)),
    (GL, Policy(jitter=2, seed=2, reciprocal=True, backwards=True, weight_bits=8)),
]


@pytest.mark.parametrize(("device", "policy"), POLICIES)
def test_a_chain_of_operations_stays_in_its_bound(device: Device, policy: Policy) -> None:
    random = np.random.default_rng(7)
    a, b = (random.normal(0, 10, (3, 20_000)) for _ in range(2))
    arithmetic = Arithmetic(policy)
    x, y = ([arithmetic.number(c) for c in each] for each in (a, b))
    found = arithmetic.power(np.abs(arithmetic.dot(arithmetic.unit(x), arithmetic.unit(y))), 9)
    found = arithmetic.lerp(found, arithmetic.divide(x[0], arithmetic.root(arithmetic.dot(y, y))), 0.25)
    bound_x, bound_y = ([uploaded(c, device) for c in each] for each in (a, b))
    bound = power(dot(unit(bound_x), unit(bound_y)).absolute(), 9)
    bound = lerp(bound, bound_x[0] / dot(bound_y, bound_y).root(), uploaded(0.25, device))
    assert bound.allows(found).all()
    assert np.median(bound.error) < 1e-4


@pytest.mark.parametrize(("device", "policy"), POLICIES)
@pytest.mark.parametrize("repeat", [False, True])
def test_a_fetch_stays_in_its_bound(device: Device, policy: Policy, repeat: bool) -> None:
    random = np.random.default_rng(3)
    texels = random.random((9, 7)).astype(np.float32).astype(np.float64)
    u, v = random.uniform(-0.3, 1.3, (2, 50_000))
    off = 10.0 ** random.uniform(-8, -0.5, (2, 50_000))
    arithmetic = Arithmetic(policy)
    moved_u, moved_v = (
        arithmetic.number(c + o * random.uniform(-1, 1, c.shape)) for c, o in zip((u, v), off, strict=True)
    )
    x, y = (arithmetic.subtract(arithmetic.multiply(c, n), 0.5) for c, n in ((moved_u, 7.0), (moved_v, 9.0)))
    (t00, t10, t01, t11), f, g = Texture(texels, repeat).cell(x, y)
    f, g = arithmetic.weight(arithmetic.number(f)), arithmetic.weight(arithmetic.number(g))
    found = arithmetic.lerp(arithmetic.lerp(t00, t10, f), arithmetic.lerp(t01, t11, f), g)
    bounds = [Bounded(c, o + np.spacing(np.float32(2.0)), device) for c, o in zip((u, v), off, strict=True)]
    bound = fetch(Texture(texels, repeat), *bounds)
    assert bound.allows(found).all()


def triangles(count: int, seed: int) -> np.ndarray:
    """(count, 3, 2) corners around a picture of 24 x 20: large, tiny and thin ones."""
    random = np.random.default_rng(seed)
    size = 10.0 ** random.uniform(-1, 1.5, (count, 1, 2))
    return random.uniform(-4, 28, (count, 1, 2)) + size * random.normal(0, 1, (count, 3, 2))


def of_each(found: Fragments) -> Iterator[tuple[int, Fragments]]:
    """The triangles that may cover any pixel, and what is found of each."""
    for triangle in np.unique(found.triangle):
        here = found.triangle == triangle
        yield int(triangle), Fragments(**{name: array[here] for name, array in vars(found).items()})


def test_the_reference_covers_what_is_certain_and_nothing_that_is_not_possible() -> None:
    width, height = 24, 20
    corners = triangles(300, 1)
    clip = np.ones((900, 4))
    clip[:, 0] = corners[..., 0].ravel() / width * 2 - 1
    clip[:, 1] = 1 - corners[..., 1].ravel() / height * 2
    clip[:, 2] = 0.5
    indices = np.arange(900, dtype=np.int32).reshape(-1, 3)
    ours = set_up(clip_triangles(clip, np.zeros((900, 1)), indices, width, height), width, height)
    snapped = np.stack([ours.x, ours.y], -1) / 256.0
    for device in PROFILES.values():
        bounds = [Bounded(corners[..., k], np.full(corners.shape[:2], 1e-6), device) for k in (0, 1)]
        for triangle, found in of_each(fragments(*bounds, width, height)):
            reference = _inside(snapped[triangle], width, height)
            assert reference[found.rows[found.certain], found.columns[found.certain]].all()
            outside = np.ones((height, width), bool)
            outside[found.rows, found.columns] = False
            assert not reference[outside].any()


@pytest.mark.parametrize("rounding", ["even", "up", "down"])
def test_every_snapping_is_among_the_possible(rounding: str) -> None:
    width, height = 24, 20
    corners = triangles(400, 2)
    device = IEEE32 if rounding == "even" else VULKAN
    arithmetic = Arithmetic(Policy(subpixel_rounding=rounding))
    jitter = np.random.default_rng(5).uniform(-1e-5, 1e-5, corners.shape)
    snapped = arithmetic.snap(corners + jitter)
    bounds = [Bounded(corners[..., k], np.full(corners.shape[:2], 1e-5), device) for k in (0, 1)]
    seen = 0
    for triangle, found in of_each(fragments(*bounds, width, height)):
        drawn = _inside(snapped[triangle], width, height)
        assert drawn[found.rows[found.certain], found.columns[found.certain]].all()
        outside = np.ones((height, width), bool)
        outside[found.rows, found.columns] = False
        assert not drawn[outside].any()
        weights = _weights(snapped[triangle], found.rows + 0.5, found.columns + 0.5)
        finite = np.isfinite(found.error)
        assert (abs(weights - found.weights).max(axis=1)[finite] <= found.error[finite] + 1e-12).all()
        seen += len(found.rows)
    assert seen > 2_000


@pytest.mark.parametrize("error", [1e-6, 1e-3, 5e-3, 0.1])
def test_snapping_covers_coordinates_that_are_off_by_many_steps(error: float) -> None:
    random = np.random.default_rng(2)
    x = random.uniform(-50, 50, 20_000)
    reference, off = snapped(Bounded(x, np.full_like(x, error), IEEE32))
    moved = Arithmetic(Policy()).snap(x + error * random.uniform(-1, 1, x.shape))
    assert (abs(moved - reference) <= off).all()
    assert (abs(moved - reference) == off).any()


def _weights(corners: np.ndarray, y: np.ndarray, x: np.ndarray) -> np.ndarray:
    edges = []
    for i in range(3):
        a, b = corners[(i + 1) % 3], corners[(i + 2) % 3]
        edges.append((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.stack(edges, 1) / np.sum(edges, axis=0)[:, None]


def _inside(corners: np.ndarray, width: int, height: int) -> np.ndarray:
    """(height, width) bool by the top-left rule, written down plainly."""
    (ax, ay), (bx, by), (cx, cy) = corners
    if (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) < 0:
        (bx, by), (cx, cy) = (cx, cy), (bx, by)
    y, x = np.mgrid[:height, :width] + 0.5
    inside = np.full((height, width), (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0)
    for (px, py), (qx, qy) in (((ax, ay), (bx, by)), ((bx, by), (cx, cy)), ((cx, cy), (ax, ay))):
        edge = (qx - px) * (y - py) - (qy - py) * (x - px)
        inside &= (edge > 0) | ((edge == 0) & (qy < py or (qy == py and qx > px)))
    return inside


def test_winners_by_drawing_depths() -> None:
    """Whatever depths are drawn from the intervals, the winner is possible; and a sure one always wins."""
    random = np.random.default_rng(11)
    pixel = random.integers(0, 200, 900)
    certain = random.random(900) < 0.7
    middle = random.random(900) * 0.5 + random.integers(0, 3, 900) * 0.3
    error = 10.0 ** random.uniform(-4, -1, 900)
    found = winners(pixel, certain, middle - error, middle + error, 200)
    for _ in range(300):
        depth = middle + error * random.uniform(-1, 1, 900)
        drawn = certain | (random.random(900) < 0.5)
        key = np.where(drawn & (depth < 1.0), depth, np.inf)
        for p in range(200):
            mine = np.flatnonzero(pixel == p)
            best = mine[np.argmin(key[mine])] if len(mine) else -1
            if best < 0 or not np.isfinite(key[best]):
                assert found.empty[p]
            else:
                assert found.possible[best]
            for i in mine[found.sure[mine]]:
                assert i == best
    assert found.sure.any()
    assert (~found.possible).any()
    assert found.empty.any()


def test_what_has_no_bound_has_none_in_a_product_either() -> None:
    """0 times a number that may be anything is not taken for a number that is nothing."""
    device = PROFILES["gl"]
    anything = exact([1.0], device) / Bounded(np.array([0.5]), np.array([1.0]), device)
    for found in (exact([0.0], device) * anything, anything * exact([0.0], device)):
        assert found.error.tolist() == [np.inf]
        assert found.allows([3.0]).all()


@pytest.mark.parametrize(("device", "policy"), POLICIES)
def test_a_unit_vector_whose_sign_is_open_may_exceed_one_by_its_roundings(device: Device, policy: Policy) -> None:
    """A wall's normal along an axis: the reference has 1, the port a little more than 1 on the other side."""
    random = np.random.default_rng(11)
    vectors = random.normal(0, 1, (3, 20_000)) * (random.random((3, 20_000)) < 0.5)
    vectors = vectors[:, np.abs(vectors).max(axis=0) > 1e-3]
    arithmetic = Arithmetic(policy)
    found = np.stack(arithmetic.unit([arithmetic.number(c) for c in vectors])).astype(np.float64)
    reference = -vectors / np.sqrt((vectors * vectors).sum(axis=0))
    apart = np.abs(found - reference).max()
    assert 2.0 <= apart <= opposite(device)


@pytest.mark.parametrize("repeat", [False, True])
@pytest.mark.parametrize("device", [IEEE32, GL], ids=lambda d: d.name)
def test_no_fetch_is_higher_than_what_lies_around(device: Device, repeat: bool) -> None:
    """Textures from 1 x 1 on, places within the error and beyond the unit square; most bounds tell something."""
    random, finite = np.random.default_rng(3), []
    for _ in range(200):
        height, width = random.integers(1, 17, 2)
        texture = Texture(random.random((height, width)), repeat)
        u, v = (Bounded(random.uniform(-0.5, 1.5, 500), 10.0 ** random.uniform(-7, 0, 500), device) for _ in range(2))
        most = highest_around(texture, u, v)
        for _ in range(4):
            x, y = ((c.value + random.uniform(-1, 1, 500) * c.error) * n - 0.5 for c, n in ((u, width), (v, height)))
            assert (texture.bilinear(x, y) <= most).all()
        finite.append(np.isfinite(most).mean())
    assert np.mean(finite) > 0.5


def test_where_nothing_is_known_of_a_place_nothing_is_of_the_height() -> None:
    place = Bounded(np.array([np.nan, np.inf, 0.5]), np.array([0.0, 0.0, np.inf]), IEEE32)
    assert highest_around(Texture(np.ones((4, 4))), place, place).tolist() == [np.inf] * 3
