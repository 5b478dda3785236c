"""Base and auxiliary faces: what the side faces add, and that they take nothing away (sections 3.2.1 and 3.2.2)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from ibr_ref import BasePolygon, Camera, models
from ibr_ref.io import Frame
from tests.displacement.scenes import block, camera, frame, noise, parallel_camera, same, square

eyes = st.tuples(st.floats(-1.0, 2.0), st.floats(-1.0, 2.0), st.floats(0.02, 2.0))
derandomized = settings(derandomize=True, deadline=None, max_examples=25)


@derandomized
@given(eyes, st.booleans(), st.sampled_from([1, 7, 10]), st.sampled_from([0, 5]))
def test_inside_the_base_nothing_changes_with_the_auxiliary_faces(
    eye: tuple[float, float, float], parallel: bool, linear_steps: int, shadow_steps: int
) -> None:
    """All arrays of all pixels whose face is the base are those of faces="base", bit for bit; and these are all pixels
    that faces="base" covers: the faces turned away from the eye lie side by side."""
    view = (parallel_camera if parallel else camera)(eye, target=(0.5, 0.5, 0.0), up=(0.1, 1.0, 0.2))
    polygon = square(noise(12, 9), facade_map=noise(4, 4, 3))
    given_ = {"linear_steps": linear_steps, "shadow_steps": shadow_steps}
    auxiliary, base = frame(polygon, view, **given_), frame(polygon, view, faces="base", **given_)
    inside = auxiliary.stages["raster.face"] == 0
    assert (inside == (base.stages["raster.face"] == 0)).all()
    assert inside.any()
    for name, array in base.stages.items():
        if not name.startswith("vertex."):
            assert same(auxiliary.stages[name][inside], array[inside]), name
    assert same(auxiliary.color[inside], base.color[inside])
    assert same(auxiliary.depth[inside], base.depth[inside])


BOX, CITY = models.box(), models.city()
VIEWS = {
    "box": (BOX, Camera.look_at(eye=(0.7, -0.75, 0.4), target=(0, 0, 0.05), width=128, height=96)),
    "box, low": (BOX, Camera.look_at(eye=(0.8, -0.7, 0.24), target=(0, 0, 0.05), width=128, height=96)),
    "city": (CITY, Camera.look_at(eye=(2.5, -3.5, 1.6), target=(0, 0, 0.1), width=128, height=96)),
    "city, low": (CITY, Camera.look_at(eye=(2.4, -2.6, 1.0), target=(0, 0, 0.1), width=128, height=96)),
}
LEAST_LOSS = {"box": 0.07, "box, low": 0.13, "city": 0.03, "city, low": 0.04}
"""What the base alone lacks of the silhouette, as a part of it: the walls at the map's border, and what is behind them."""


def shown(result: Frame) -> NDArray[np.bool_]:
    return result.depth < 1


def agreement(a: NDArray[np.bool_], b: NDArray[np.bool_]) -> float:
    """Intersection over union."""
    return float((a & b).sum() / (a | b).sum())


@pytest.mark.parametrize("name", VIEWS)
def test_the_silhouette_is_that_of_the_solid(name: str) -> None:
    """At N = 50; the paper's base face alone (figure 6c) cuts off what sticks out."""
    polygon, view = VIEWS[name]
    truth = shown(frame(polygon, view, method="exact"))
    auxiliary = shown(frame(polygon, view, linear_steps=50))
    base = shown(frame(polygon, view, linear_steps=50, faces="base"))
    print(name, truth.sum(), agreement(auxiliary, truth), agreement(base, truth))
    assert agreement(auxiliary, truth) >= 0.99
    assert not (auxiliary & ~truth).any(), "the search shows nothing that is not there"
    assert not (base & ~auxiliary).any()
    assert agreement(base, truth) <= 1 - LEAST_LOSS[name]


@pytest.mark.parametrize("name", ["box", "box, low"])
def test_a_box_at_the_border_overflows_the_base(name: str) -> None:
    """The box moved to the far corner of the map: without auxiliary faces a good part of it is cut off."""
    _, view = VIEWS[name]
    polygon = BasePolygon(
        corner=(-0.5, -0.5, 0.0), edge_u=(1, 0, 0), edge_v=(0, 1, 0), height_scale=0.2,
        height_map=block(64, 64, 40, 64, 0.93)[:, ::-1], color_map=noise(4, 4, 3),
    )  # fmt: skip
    truth = shown(frame(polygon, view, method="exact"))
    auxiliary = shown(frame(polygon, view, linear_steps=50))
    base = shown(frame(polygon, view, linear_steps=50, faces="base"))
    print(name, truth.sum(), agreement(auxiliary, truth), agreement(base, truth))
    assert agreement(auxiliary, truth) >= 0.99
    assert agreement(base, truth) <= 0.95


@derandomized
@given(st.floats(-1.0, 2.0), st.floats(-1.0, 2.0), st.floats(0.3, 2.0), st.booleans())
def test_the_extended_base_shows_what_the_auxiliary_faces_show(u: float, v: float, z: float, parallel: bool) -> None:
    """The same rays, from another point C. Rasterization snaps the large rectangle elsewhere: by 1/512 pixel, so that
    only pixels on outlines differ (2 % of a picture of 48 x 36 here), and nothing is seen in places that are empty."""
    view = (parallel_camera if parallel else camera)((u, v, z), target=(0.5, 0.5, 0.0), up=(0.1, 1.0, 0.2))
    polygon = square(block(32, 32, 4, 28, 0.9))
    auxiliary, extended = frame(polygon, view, linear_steps=50), frame(polygon, view, linear_steps=50, faces="extended")
    assert agreement(shown(auxiliary), shown(extended)) > 0.97
    both = shown(auxiliary) & shown(extended)
    near = abs(auxiliary.stages["march.hit"] - extended.stages["march.hit"])[both].max(axis=1) < 0.01
    assert near.mean() > 0.97


FACES_FROM: list[tuple[Any, str, list[int]]] = [
    ((0.5, 0.5, 3.0), "paper", [0, 1, 2, 3, 4]),
    ((-1.0, 0.5, 1.0), "paper", [0, 2, 3, 4]),
    ((2.0, -1.0, 1.0), "paper", [0, 1, 4]),
    ((2.0, -1.0, -1.0), "paper", [1, 4]),
    ((0.5, 0.5, 0.1), "paper", [0, 1, 2, 3, 4]),
    ((0.5, 0.5, 0.1), "volume", [0, 1, 2, 3, 4, 5]),
    ((0.5, 0.5, 3.0), "volume", [0, 1, 2, 3, 4]),
    ((2.0, -1.0, -1.0), "volume", [1, 4, 5]),
    ((1.0, 0.0, 0.5), "paper", [0, 1, 4]),
    ((2.0, 1.0, 0.0), "paper", [1, 3]),
    ((0.0, 0.5, 0.25), "volume", [0, 2, 3, 4]),
]


@pytest.mark.parametrize(("eye", "interval", "numbers"), FACES_FROM)
def test_the_faces_turned_away_from_the_eye_are_drawn(eye: Any, interval: str, numbers: list[int]) -> None:
    """In the order of their numbers, four corners each. On the plane of a face it is seen from its edge: not drawn."""
    view = camera(eye, target=(0.55, 0.45, 0.05), up=(0.1, 1.0, 0.2))
    patch = frame(square(noise(4, 4)), view, interval=interval).stages["vertex.patch"].reshape(-1, 4, 3)
    planes = [(2, 0.0), (0, 0.0), (0, 1.0), (1, 0.0), (1, 1.0), (2, 1.0)]
    assert len(patch) == len(numbers)
    for quad, number in zip(patch, numbers, strict=True):
        axis, side = planes[number]
        assert (quad[:, axis] == side).all()
        assert sorted(map(tuple, np.delete(quad, axis, axis=1).tolist())) == [(0, 0), (0, 1), (1, 0), (1, 1)]


def test_nothing_is_drawn_of_a_base_seen_from_below() -> None:
    result = frame(square(noise(4, 4)), camera((0.5, 0.4, -1.0), up=(0, 1, 0)), faces="base")
    assert result.stages["vertex.patch"].shape == (0, 3)
    assert result.stages["vertex.clip"].shape == (0, 4)
    assert (result.stages["raster.face"] == -1).all()
    assert (result.depth == 1).all()
