"""The law of the width, on single points: W_s = alpha / (beta d^2 + gamma d + delta), clamped."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from ibr_ref import Camera, DepthImage, splatting
from ibr_ref.splatting import Params, Scene
from tests.splatting.scenes import Array, frame, looking, noise, parallel, points

pytestmark = pytest.mark.usefixtures("one_thread")

derandomized = settings(derandomize=True, deadline=None, max_examples=100)
WIDE: dict[str, float] = {"min_width": 0.0, "max_width": 2.0**20}
"""Never clamped."""


def row_of(depths: list[float]) -> DepthImage:
    """Points on parallel lines of sight, at these depths from the plane through the origin, along -z."""
    camera = parallel((0, 0, 0), (0, 0, -1), size=(len(depths), 1), up=(0, 1, 0), view_height=1e-3, near=0.0, far=1e4)
    return DepthImage(color=np.ones((1, len(depths), 3)), depth=[depths], camera=camera)


def widths(depths: list[float], *, flat: bool = True, **law: Any) -> Array:
    """(n,) the widths of points at these distances (orthographic: along the axis)."""
    image = row_of(depths)
    view = image.camera if flat else looking((0, 0, 0), (0, 0, -1), up=(0, 1, 0), near=1e-3, far=1e5)
    return np.asarray(frame([image], view, **law).stages["vertex.width"])


distances = st.lists(st.floats(0.01, 1000.0), min_size=2, max_size=12)
positive = st.floats(0.0, 10.0)


@derandomized
@given(distances, st.floats(0.01, 100.0), positive, positive, st.floats(0.001, 10.0))
def test_the_width_is_the_laws(depths: list[float], alpha: float, beta: float, gamma: float, delta: float) -> None:
    """To five roundings of sums and quotients of positive numbers."""
    found = widths(depths, alpha=alpha, beta=beta, gamma=gamma, delta=delta, **WIDE)
    for d, width in zip(map(Fraction, depths), found.tolist(), strict=True):
        exact = Fraction(alpha) / (Fraction(beta) * d * d + Fraction(gamma) * d + Fraction(delta))
        assert abs(Fraction(width) - exact) <= 5 * Fraction(1, 2**53) * exact


@derandomized
@given(distances, st.floats(0.01, 100.0), positive, positive, st.floats(0.001, 10.0), positive, st.booleans())
def test_farther_points_are_never_wider(
    depths: list[float], alpha: float, beta: float, gamma: float, delta: float, least: float, flat: bool
) -> None:
    """beta, gamma >= 0: the denominator grows with d. Rounding keeps the order of all sums and quotients, so that there is
    nothing to allow for; the clamps keep it as well.
    """
    found = widths(
        sorted(depths), flat=flat, alpha=alpha, beta=beta, gamma=gamma, delta=delta, min_width=least, max_width=15
    )
    if flat:
        assert (np.diff(found) <= 0.0).all()
    else:  # lines of sight at 1e-3 from one another: the order of the depths is that of the distances from 0.1 on
        near, apart = np.array(sorted(depths)), np.diff(sorted(depths))
        assert (np.diff(found)[(near[:-1] > 0.1) & (apart > 1e-4)] <= 0.0).all()
    assert ((found >= least) & (found <= max(15.0, least))).all()


@derandomized
@given(distances, st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_the_width_falls_wherever_the_polynomial_grows(
    depths: list[float], beta: float, gamma: float, delta: float
) -> None:
    """Whatever the signs: where one exact denominator is greater than another by more than rounding, the width is less."""

    def polynomial(d: float) -> Fraction:
        return Fraction(beta) * Fraction(d) ** 2 + Fraction(gamma) * Fraction(d) + Fraction(delta)

    def size(d: float) -> Fraction:
        return abs(Fraction(beta)) * Fraction(d) ** 2 + abs(Fraction(gamma)) * Fraction(d) + abs(Fraction(delta))

    depths = [d for d in depths if polynomial(d) > max(size(d), 1) / 10**6]
    if not depths:
        return
    found = dict(zip(depths, widths(depths, alpha=1e-3, beta=beta, gamma=gamma, delta=delta, **WIDE), strict=True))
    for near in depths:
        for far in depths:
            if polynomial(far) - polynomial(near) > max(size(near), size(far)) / 10**12:
                assert found[far] < found[near]


def test_d_is_from_the_eye_and_without_perspective_along_the_axis() -> None:
    camera = looking((1, -3, 2), size=(9, 7))
    image = DepthImage(color=noise(7, 9, 3), depth=2.0 + noise(7, 9), camera=camera)
    p = points(image).reshape(-1, 3)
    law = {"alpha": 10.0, "gamma": 1.0, "delta": 0.0, **WIDE}
    view = looking((2, -3, 1))
    found = frame([image], view, **law).stages["vertex.width"]
    np.testing.assert_allclose(10.0 / found, np.sqrt(((p - view.eye[:3]) ** 2).sum(axis=1)), rtol=1e-14)
    view = parallel((2, -3, 1))
    found = frame([image], view, **law).stages["vertex.width"]
    np.testing.assert_allclose(10.0 / found, ((2, -3, 1) - p) @ view.eye[:3], rtol=1e-12)


@derandomized
@given(
    st.tuples(*[st.floats(0.5, 8.0)] * 3),
    st.tuples(st.floats(0.1, 9.0), positive, positive, st.floats(0.0, 5.0)),
    st.sampled_from([(0.0, 2.0**20), (1.0, 64.0), (2.5, 3.0)]),
)
def test_half_the_distance_does_not_shrink_a_splat(
    eye: tuple[float, float, float], law: tuple[float, float, float, float], clamps: tuple[float, float]
) -> None:
    """One point, at the origin, and an eye that comes half the way: every number of its d is halved exactly. Wider at most
    fourfold, and that exactly if it falls with d^2, twice if with d.
    """
    alpha, beta, gamma, delta = law[0], law[1], law[2], law[3] + 1e-3
    reference = Camera.look_at(eye=(0, -4, 0), target=(0, 0, 0), width=1, height=1)
    image = DepthImage(color=np.ones((1, 1, 3)), depth=[[4.0]], camera=reference)

    def width(share: float, *coefficients: float, **limits: float) -> float:
        view = looking(np.array(eye) * share, near=0.01, far=100.0)
        values = dict(zip(("alpha", "beta", "gamma", "delta"), coefficients, strict=True))
        return float(frame([image], view, **values, **limits).stages["vertex.width"][0])

    limits = {"min_width": clamps[0], "max_width": clamps[1]}
    far, near = width(1.0, alpha, beta, gamma, delta, **limits), width(0.5, alpha, beta, gamma, delta, **limits)
    assert far <= near <= 4.0 * far
    assert width(0.5, alpha, 1.0, 0.0, 0.0, **WIDE) == 4.0 * width(1.0, alpha, 1.0, 0.0, 0.0, **WIDE)
    assert width(0.5, alpha, 0.0, 1.0, 0.0, **WIDE) == 2.0 * width(1.0, alpha, 0.0, 1.0, 0.0, **WIDE)
    assert width(0.5, alpha, 0.0, 0.0, 1.0, **WIDE) == alpha


@pytest.mark.parametrize(("least", "most", "expected"), [
    (1.0, 64.0, [64.0, 10.0, 1.0]),
    (0.0, 64.0, [64.0, 10.0, 0.1]),
    (12.0, 12.0, [12.0, 12.0, 12.0]),
    (0.0, 0.0, [0.0, 0.0, 0.0]),
    (0.0, 2.0**20, [100.0, 10.0, 0.1]),
])  # fmt: skip
def test_widths_are_clamped(least: float, most: float, expected: list[float]) -> None:
    found = widths([0.1, 1.0, 100.0], alpha=10.0, gamma=1.0, delta=0.0, min_width=least, max_width=most)
    np.testing.assert_allclose(found, expected, rtol=1e-15)


# Denominators


def unsound(image: DepthImage, view: Camera, **law: float) -> str:
    """The message that the law is rejected with; the same with stages and without."""
    messages = set()
    for stages in (True, False):
        with pytest.raises(ValueError, match=r"^beta, gamma, delta: found .*, allowed: .*denominator is > 0") as error:
            splatting.render(Scene(images=[image], camera=view, light=None), Params(**law), stages=stages)
        messages.add(str(error.value))
    assert len(messages) == 1
    message = messages.pop()
    assert "\n" not in message
    return message


@pytest.mark.parametrize("law", [
    {"delta": 0.0},
    {"delta": -1.0},
    {"gamma": 1.0, "delta": -2.0},
    {"gamma": 1.0, "delta": -2.5},
    {"beta": -1.0, "delta": 3.0},
    {"beta": 1e300, "gamma": -1e308, "delta": 0.0},
    {"beta": 1e308, "gamma": -1e308, "delta": 1e308},
])  # fmt: skip
def test_a_denominator_that_is_not_positive_is_an_error(law: dict[str, float]) -> None:
    """Nor one that overflows to what is no number. It names the law, the image and its rows."""
    image = row_of([1.0, 2.0, 3.0])
    depth = 1e200 if law.get("beta", 0) > 1e307 else None
    if depth:
        camera = parallel((0, 0, 0), (0, 0, -1), size=(1, 1), up=(0, 1, 0), view_height=1e-3, near=0.0, far=1e201)
        image = DepthImage(color=np.ones((1, 1, 3)), depth=[[depth]], camera=camera)
    message = unsound(image, image.camera, **law)
    assert "images[0], rows 0 to 0" in message
    assert f"{law.get('beta', 0.0):g} d^2 + {law.get('gamma', 0.0):g} d + {law['delta']:g}" in message


def test_the_bad_point_is_found_wherever_it_is() -> None:
    """In the last image, at its last pixel; the message names that image and a row range with it."""
    near = DepthImage(color=noise(60, 80, 3), depth=2.0 + noise(60, 80), camera=looking((0, 0, 0), (0, 0, -1), up=(0, 1, 0),
                                                                                         size=(80, 60)))  # fmt: skip
    depth = np.asarray(near.depth).copy()
    depth[-1, -1] = 9.0
    far = DepthImage(color=near.color, depth=depth, camera=near.camera)
    law = {"gamma": -1.0, "delta": 6.0}
    frame([near, near], near.camera, **law)
    scene = Scene(images=[near, near, far], camera=near.camera, light=None)
    with pytest.raises(ValueError, match=r"images\[2\]") as error:
        splatting.render(scene, Params(**law))
    first, last = map(int, re.findall(r"rows (\d+) to (\d+)", str(error.value))[0])
    assert first <= 59 <= last


@pytest.mark.parametrize("where", ["behind the eye", "before the near plane", "beyond the far plane"])
def test_points_that_are_dropped_need_no_positive_denominator(where: str) -> None:
    """Two points, one in view at d = 2; the other would be at fault, and is not seen."""
    other = {"behind the eye": -3.0, "before the near plane": 0.2, "beyond the far plane": 30.0}[where]
    law = {"gamma": -1.0, "delta": 2.5} if other != 0.2 else {"gamma": 1.0, "delta": -1.0}
    camera = parallel((0, 0, 50), (0, 0, 0), size=(2, 1), up=(0, 1, 0), view_height=1e-3, near=0.0, far=1e4)
    image = DepthImage(color=np.ones((1, 2, 3)), depth=[[50.0 + 2.0, 50.0 + other]], camera=camera)
    view = looking((0, 0, 0), (0, 0, -1), up=(0, 1, 0), near=0.5, far=20.0)
    found = frame([image], view, **law).stages
    assert found["vertex.width"][0] > 0.0
    assert found["vertex.width"][1] == 0.0
    unsound(image, looking((0, 0, 0), (0, 0, -1), up=(0, 1, 0), near=0.1, far=40.0) if other > 0 else
            looking((0, 0, 10), (0, 0, 0), up=(0, 1, 0), near=0.5, far=20.0), **law)  # fmt: skip


def test_points_beside_the_picture_need_a_positive_denominator() -> None:
    """They are not dropped: their splats may reach in."""
    image = row_of([3.0])
    view = looking((50, 0, 0), (50, 0, -1), up=(0, 1, 0), near=0.5, far=20.0)
    assert (frame([image], view).stages["raster.splat"] == -1).all()
    unsound(image, view, gamma=-1.0, delta=2.0)


def test_widths_of_0_show_nothing() -> None:
    found = frame([row_of([1.0, 2.0])], row_of([1.0, 2.0]).camera, min_width=0.0, max_width=0.0)
    assert_array_equal(found.stages["vertex.width"], 0.0)
    assert (found.stages["raster.overdraw"] == 0).all()
