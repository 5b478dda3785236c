"""Polygons with mirrored edges, told by `up`: the surface that they mean, in a right-handed frame, drawn and judged."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from numpy.typing import ArrayLike, NDArray

from ibr_ref import BasePolygon, Camera, Light, displacement, oracle
from ibr_ref.displacement import Params, Scene, render
from ibr_ref.oracle import Outcome
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.programs.displacement.port import Port
from tests.displacement.scenes import noise

HEIGHTS = 0.5 * noise(6, 9, seed=1) + 0.2
COLORS, NORMALS = noise(5, 4, 3, seed=2), 0.2 * noise(3, 5, 3, seed=3) + [0.3, 0.5, 0.8]


def polygon(edge_u: ArrayLike, edge_v: ArrayLike, **more: Any) -> BasePolygon:
    values: dict[str, Any] = {
        "corner": (0.5, -0.4, 0.1),
        "height_map": HEIGHTS,
        "color_map": COLORS,
        "height_scale": 0.25,
    }
    return BasePolygon(edge_u=edge_u, edge_v=edge_v, **{**values, **more})


def bilinear(image: NDArray[np.float64], u: float, v: float) -> NDArray[np.float64]:
    x, y = u * image.shape[1] - 0.5, v * image.shape[0] - 0.5
    j, i = int(np.floor(x)), int(np.floor(y))
    texel = [
        [image[np.clip(i + b, 0, len(image) - 1), np.clip(j + a, 0, image.shape[1] - 1)] for a in (0, 1)]
        for b in (0, 1)
    ]
    f, g = x - j, y - i
    return (texel[0][0] * (1 - f) + texel[0][1] * f) * (1 - g) + (texel[1][0] * (1 - f) + texel[1][1] * f) * g


def surface(p: BasePolygon, u: float, v: float, n: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """The point over (u, v) on the side of n, its colour, and its normal in the frame of the edges and n, in world space."""
    corner, edge_u, edge_v = (np.asarray(a, float) for a in (p.corner, p.edge_u, p.edge_v))
    point = corner + u * edge_u + v * edge_v + float(bilinear(np.asarray(p.height_map), u, v)) * p.height_scale * n
    normal = 2.0 * bilinear(np.asarray(p.normal_map), u, v) - 1.0
    axes = edge_u / np.linalg.norm(edge_u), edge_v / np.linalg.norm(edge_v), n
    return point, bilinear(np.asarray(p.color_map), u, v), sum(c * axis for c, axis in zip(normal, axes, strict=True))


@pytest.mark.parametrize(
    ("edge_u", "edge_v"), [((-1, 0, 0), (0, 0.8, 0)), ((1, 0, 0), (0, -0.8, 0)), ((0, 1, 0), (2, 0, 0))]
)
def test_the_same_surface_counted_from_the_other_end(edge_u: ArrayLike, edge_v: ArrayLike) -> None:
    """Points, colours and normals over (u, v) of the edges as given are those over (1 - u, v) of the polygon's own."""
    z = np.array([0.0, 0.0, 1.0])
    left = polygon(edge_u, edge_v, normal_map=NORMALS)  # as it is stored without `up`: with n downwards
    right = polygon(edge_u, edge_v, normal_map=NORMALS, up=(0.1, 0.2, 3))
    corner, own_u, own_v = right.arrays
    assert np.cross(own_u, own_v)[2] > 0.0
    assert_array_equal(corner, np.asarray(left.corner) + edge_u)
    for u, v in np.random.default_rng(0).random((40, 2)):
        for ours, meant in zip(surface(right, 1 - u, v, z), surface(left, u, v, z), strict=True):
            np.testing.assert_allclose(ours, meant, rtol=0, atol=1e-12)


def test_up_changes_nothing_where_edges_are_not_mirrored() -> None:
    plain, with_up = polygon((1, 0, 0), (0, 1, 0)), polygon((1, 0, 0), (0, 1, 0), up=(0, -3, 0.1))
    for name in ("corner", "edge_u", "edge_v", "height_map", "color_map"):
        assert_array_equal(getattr(with_up, name), getattr(plain, name))
    again = replace(polygon((-1, 0, 0), (0, 1, 0), up=(0, 0, 1)), height_scale=0.5)
    assert_array_equal(again.height_map, HEIGHTS[:, ::-1])  # a copy is not mirrored once more


@pytest.mark.parametrize("up", [(1, 2, 0), (0, 0, 0), (0, 0), (0, 0, float("nan")), "up"])
def test_up_that_says_no_side(up: object) -> None:
    with pytest.raises(ValueError, match=r"^up: found"):
        polygon((1, 0, 0), (0, 1, 0), up=up)


def seen(mirrored: bool, **more: Any) -> Scene:
    """The polygon and the light, or both reflected in the plane x = 0, before a camera in that plane."""
    sign = -1.0 if mirrored else 1.0
    camera = Camera.look_at(
        eye=(0, -1.6, 1.1), target=(0, 0, 0.1), vertical_fov=30, width=96, height=72, near=0.1, far=9
    )
    drawn = polygon((-sign, 0, 0), (0, 0.8, 0), corner=(0.5 * sign, -0.4, 0.1), up=(0, 0, 1), **more)
    return Scene(polygons=[drawn], camera=camera, light=Light(direction=(0.4 * sign, -0.3, 1.0), specular=0.3))


@pytest.mark.parametrize("more", [{}, {"normal_map": NORMALS}], ids=["heights", "normals"])
@pytest.mark.parametrize("params", [Params(shadow_steps=4), Params(method="exact"), Params(method="relief")])
def test_the_mirrored_world_is_the_mirrored_picture(params: Params, more: dict[str, Any]) -> None:
    """But for what snapped corners, and quads cut along the other diagonal, move: some 1e-4 of a pixel."""
    first, second = render(seen(False, **more), params), render(seen(True, **more), params)
    assert np.abs(first.color - second.color[:, ::-1]).max() < 5e-3
    assert (np.abs(first.color - second.color).max(axis=2) > 0.05).mean() > 0.15


@pytest.fixture(scope="module")
def case() -> oracle.Case:
    params = displacement.Params(linear_steps=20, binary_steps=4, steep_threshold=0.123)
    return oracle.Case(
        name="displacement-mirrored", method="displacement", kind="easy", about="Mirrored edges.", profile="ieee32",
        scene=seen(False, normal_map=NORMALS), params=params,
    )  # fmt: skip


def outcome(case: oracle.Case, scene: Scene) -> Outcome:
    """What is said of a plain port in float32 that draws a scene."""
    drawn = Port(scene, case.params, Policy(), case.inputs).render()
    color, depth = drawn.pop("color"), drawn.pop("depth")
    return oracle.check(
        case, oracle.submission_from_arrays(case, color=color, depth=depth, stages=drawn)
    ).verdict.outcome


@pytest.mark.long
def test_the_oracle_judges_it(case: oracle.Case, tmp_path: Path) -> None:
    """What is expected passes, and a right port; one that takes the heights as they were given fails."""
    oracle.export(case, tmp_path / "case")
    read = oracle.load_case(tmp_path / "case")
    (tmp_path / "case" / "expected" / "color.png").rename(tmp_path / "color.png")  # one of the two pictures
    expected = oracle.load_submission(tmp_path / "case" / "expected", read)
    assert len(expected.handed) > 20
    assert oracle.check(read, expected).verdict.outcome is Outcome.PASS
    assert outcome(read, case.scene) is Outcome.PASS
    wrong = replace(case.scene.polygons[0], height_map=HEIGHTS)
    assert outcome(read, replace(case.scene, polygons=[wrong])) is Outcome.FAIL
