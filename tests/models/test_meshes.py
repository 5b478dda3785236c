"""The built-in meshes: closed, wound outward, the same bits everywhere; and what each of them is."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from ibr_ref import Mesh, models
from tests.models.surfaces import assert_closed, corners, digest, parts, volumes

MESHES: dict[str, Callable[[], Mesh]] = {
    "sphere": models.sphere,
    "knot": models.knot,
    "kettle": models.kettle,
    "chair": models.chair,
    "horse": models.horse,
}
PARTS = {"sphere": 1, "knot": 1, "kettle": 3, "chair": 15, "horse": 11}
TRIANGLES = {"sphere": 3_968, "knot": 9_600, "kettle": 1_152, "chair": 1_464, "horse": 5_804}
"""The last three are what Kang & Ihm's teapot, chair and cow have, which their times are stated for."""
SIZES = {"kettle": (1.48, 1.15, 1.05), "chair": (0.56, 0.49, 0.99), "horse": (2.36, 0.56, 2.24)}
DIGESTS = {
    "sphere": "64aa3c72b2cd7dc36b44463e9f24b23baa9824447f48726b7045f179df8463da",
    "kettle": "7bf922eb48aee5f488817412d1adbd1d5135b674fd5de777f29e390e30bc489c",
    "chair": "9a32fac7a134ccfacf4d0a319e789626292c4487b17744970bf529e4e59c440c",
    "horse": "572f5ed34631bcb2f37e361405e8cd53fe03a74177d0c009aac00a9ba79c24db",
    "knot": "63b1a902b4d6147e148fb8b7e8d7259717e239081abfb019e6bb4d8d66131035",
}


@pytest.fixture(scope="module", params=MESHES)
def named(request: pytest.FixtureRequest) -> tuple[str, Mesh]:
    return request.param, MESHES[request.param]()


def test_every_part_is_closed_and_wound_outward(named: tuple[str, Mesh]) -> None:
    name, mesh = named
    assert_closed(mesh)
    found = volumes(mesh)
    assert len(found) == PARTS[name]
    assert min(found) > 0.0


def test_no_triangle_is_degenerate(named: tuple[str, Mesh]) -> None:
    a, b, c = corners(named[1]).transpose(1, 0, 2)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).min() > 1e-9


def test_meshes_have_the_same_bits_everywhere(named: tuple[str, Mesh]) -> None:
    name, mesh = named
    assert digest(mesh.vertices, mesh.triangles, mesh.color) == DIGESTS[name]


def test_colours_are_one_a_vertex(named: tuple[str, Mesh]) -> None:
    assert np.shape(named[1].color) == np.shape(named[1].vertices)


def test_meshes_have_the_numbers_of_triangles_that_they_say(named: tuple[str, Mesh]) -> None:
    name, mesh = named
    assert np.shape(mesh.triangles) == (TRIANGLES[name], 3)


@pytest.mark.parametrize("name", SIZES)
def test_what_has_a_foot_stands_on_the_plane_and_is_as_large_as_it_says(name: str) -> None:
    vertices = np.asarray(MESHES[name]().vertices)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    assert 0.0 <= low[2] < 1e-3
    np.testing.assert_allclose(high - low, SIZES[name], atol=0.01)
    np.testing.assert_allclose(low[1], -high[1], rtol=1e-12)


@pytest.mark.parametrize("name", SIZES)
def test_every_part_meets_another(name: str) -> None:
    """Nothing floats: a vertex of every part lies in the box of another, and all hang together."""
    mesh = MESHES[name]()
    names, triangles = parts(mesh), np.asarray(mesh.triangles)
    groups = [np.asarray(mesh.vertices)[np.unique(triangles[names == part])] for part in np.unique(names)]
    reached, waiting = {0}, [0]
    while waiting:
        here = groups[waiting.pop()]
        for other, points in enumerate(groups):
            inside = (points >= here.min(axis=0)) & (points <= here.max(axis=0))
            within = (here >= points.min(axis=0)) & (here <= points.max(axis=0))
            if other not in reached and (inside.all(axis=1).any() or within.all(axis=1).any()):
                reached.add(other)
                waiting.append(other)
    assert len(reached) == PARTS[name]


@pytest.mark.parametrize(("radius", "segments"), [(1.0, 4), (2.5, 8), (0.1, 62)])
def test_the_sphere_is_as_near_to_one_as_it_says(radius: float, segments: int) -> None:
    mesh = models.sphere(radius, segments)
    distances = np.linalg.norm(np.asarray(mesh.vertices), axis=1)
    np.testing.assert_allclose(distances, radius, rtol=1e-15)
    assert len(np.asarray(mesh.triangles)) == 2 * segments * (segments // 2 - 1)
    a, b, c = corners(mesh).transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    heights = (normal * a).sum(axis=1) / np.linalg.norm(normal, axis=1)
    bound = radius * math.sqrt(max(0.0, math.cos(2.0 * math.pi / segments)))
    assert heights.min() >= bound - 1e-7 * radius


def test_the_volume_of_the_sphere_is_that_of_its_formula() -> None:
    assert volumes(models.sphere(2.0, 128)) == pytest.approx([32.0 / 3.0 * math.pi], rel=2e-3)


def test_the_cord_of_the_knot_is_round_and_stays_clear_of_itself() -> None:
    segments, sides = 240, 20
    rings = np.asarray(models.knot(segments, sides).vertices).reshape(segments, sides, 3)
    centers = rings.mean(axis=1)
    np.testing.assert_allclose(np.linalg.norm(rings - centers[:, None], axis=2), 0.14, rtol=1e-12)
    apart = np.linalg.norm(centers[:, None] - centers, axis=2)
    step = np.abs(np.arange(segments)[:, None] - np.arange(segments))
    far_along = np.minimum(step, segments - step) > segments // 8
    assert apart[far_along].min() > 2 * 0.14


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: models.sphere(0.0), "radius"),
        (lambda: models.sphere(math.nan), "radius"),
        (lambda: models.sphere(1.0, 7), "segments"),
        (lambda: models.sphere(1.0, 2), "segments"),
        (lambda: models.sphere(1.0, 10**9), "segments"),
        (lambda: models.knot(11), "segments"),
        (lambda: models.knot(240, 2), "sides"),
        (lambda: models.knot(240, 4.5), "sides"),  # type: ignore[arg-type]
    ],
)
def test_bad_arguments_are_named(make: Callable[[], Mesh], field: str) -> None:
    with pytest.raises(ValueError, match=rf"^{field}: found .*allowed: [^\n]*$"):
        make()
