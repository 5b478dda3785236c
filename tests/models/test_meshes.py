"""The built-in meshes: closed, wound outward, the same bits everywhere; and what each of them is."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from ibr_ref import Mesh, models
from tests.models.surfaces import assert_closed, corners, digest, volumes

MESHES: dict[str, Callable[[], Mesh]] = {"sphere": models.sphere, "knot": models.knot}
PARTS = {"sphere": 1, "knot": 1}
DIGESTS = {
    "sphere": "64aa3c72b2cd7dc36b44463e9f24b23baa9824447f48726b7045f179df8463da",
    "knot": "05670d6e0a54591fe8f5706cc0bdabd8d4addefa331fc7d611b87529d7fa5618",
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
