"""Views in which nothing is seen, or in which a right port may see nothing: neither is a port that did not draw."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from ibr_ref import displacement, methods, oracle, shadows, splatting
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.scene import BasePolygon, Camera, DepthImage, Light, Mesh

pytestmark = pytest.mark.usefixtures("one_thread")

BACKGROUND = (0.1, 0.2, 0.3)
FAR = 4.0
JUST = FAR * (1.0 - 1e-9)
"""A distance that float32 does not tell from the far plane's, which hides what lies on it."""
SQUARE = np.array([(-9.0, -9.0, 0.0), (9.0, -9.0, 0.0), (9.0, 9.0, 0.0), (-9.0, 9.0, 0.0)])


def looking(eye: tuple[float, float, float], target: tuple[float, float, float]) -> Camera:
    return Camera.look_at(eye=eye, target=target, up=(0, 1, 0), vertical_fov=40.0, near=1.0, far=FAR, width=8, height=6)


VIEWS = {
    "beside": looking((60.0, 0.0, 3.0), (60.0, 0.0, 0.0)),
    "behind the eye": looking((0.0, 0.0, 3.0), (0.0, 0.0, 6.0)),
    "beyond the far plane": looking((0.0, 0.0, 2.0 * FAR), (0.0, 0.0, 0.0)),
    "before the near plane": looking((0.0, 0.0, 0.5), (0.0, 0.0, 0.0)),
}
"""Of a square in z = 0."""
BORDERLINE = looking((0.0, 0.0, JUST), (0.0, 0.0, 0.0))


def polygon(camera: Camera) -> Case:
    flat = BasePolygon(
        corner=SQUARE[0], edge_u=(18, 0, 0), edge_v=(0, 18, 0), height_map=np.zeros((2, 2)),
        color_map=np.ones((2, 2, 3)), height_scale=1e-3,
    )  # fmt: skip
    scene = displacement.Scene(polygons=[flat], camera=camera, light=Light(direction=(0, 0, 1)), background=BACKGROUND)
    return Case(scene=scene, params=displacement.Params(faces="base"), profile="ieee32")


def points(camera: Camera) -> Case:
    own = Camera.look_at(eye=(0, 0, 2), target=(0, 0, 0), up=(0, 1, 0), vertical_fov=20.0, width=3, height=3)
    image = DepthImage(color=np.ones((3, 3, 3)), depth=np.full((3, 3), 2.0), camera=own)
    scene = splatting.Scene(images=[image], camera=camera, light=None, background=BACKGROUND)
    return Case(scene=scene, params=splatting.Params(alpha=2.0, max_width=4.0), profile="ieee32")


def floor(camera: Camera) -> Case:
    square = Mesh(vertices=SQUARE, triangles=[(0, 1, 2), (0, 2, 3)], color=(1.0, 1.0, 1.0))
    plate = Mesh(vertices=0.01 * SQUARE + (0, 0, 30), triangles=[(0, 1, 2), (0, 2, 3)], color=(1.0, 0.0, 0.0))
    light = shadows.AreaLight(
        position=(0, 0, 40), target=(0, 0, 0), up=(0, 1, 0), vertical_fov=40.0, near=1.0, far=90.0
    )
    scene = shadows.Scene(
        receivers=[square], caster=plate, light=light, camera=camera, background=BACKGROUND,
        offset_range=((-0.1, 0.1), (-0.1, 0.1)), offset=(0.0, 0.0),
    )  # fmt: skip
    return Case(scene=scene, params=shadows.Params(method="direct", map_size=8), profile="ieee32")


CASES: dict[str, Callable[[Camera], Case]] = {"displacement": polygon, "splatting": points, "shadows": floor}


def drawn(case: Case) -> dict[str, Any]:
    """By a right port in float32, with all stages."""
    port = methods.named(case.method).plain_port
    assert port is not None
    arrays: dict[str, Any] = port.open().Port(case.scene, case.params, Policy(), case.inputs).render()
    return arrays


def verdict(case: Case, arrays: dict[str, Any], *, with_stages: bool) -> oracle.Verdict:
    stages = {name: array for name, array in arrays.items() if name not in ("color", "depth")}
    submission = oracle.submission_from_arrays(
        case, color=arrays["color"], depth=arrays["depth"], stages=stages if with_stages else None
    )
    return oracle.check(case, submission).verdict


def is_blank(color: Any) -> bool:
    return bool(np.allclose(color, BACKGROUND, atol=1e-6))


@pytest.mark.parametrize("with_stages", [True, False])
@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("method", CASES)
def test_nothing_is_seen(method: str, view: str, with_stages: bool) -> None:
    case = CASES[method](VIEWS[view])
    assert is_blank(case.frame.color)
    found = verdict(case, drawn(case), with_stages=with_stages)
    assert found.outcome is oracle.Outcome.PASS, found.words()


@pytest.mark.parametrize("with_stages", [True, False])
@pytest.mark.parametrize("method", CASES)
def test_a_right_port_may_see_nothing(method: str, with_stages: bool) -> None:
    case = CASES[method](BORDERLINE)
    assert not is_blank(case.frame.color)
    arrays = drawn(case)
    seen = ~np.isclose(arrays["color"], BACKGROUND, atol=1e-6).all(axis=-1)
    assert not seen.all() if method == "shadows" else not seen.any()  # of its floor, here and there
    found = verdict(case, arrays, with_stages=with_stages)
    assert found.outcome is oracle.Outcome.PASS, found.words()


@pytest.mark.parametrize("method", CASES)
def test_a_port_that_did_not_draw(method: str) -> None:
    case = CASES[method](looking((0.0, 0.0, 3.0), (1.4, 0.0, 0.0)))
    color = np.broadcast_to(BACKGROUND, case.frame.color.shape).copy()
    found = verdict(case, {"color": color, "depth": np.ones(color.shape[:2])}, with_stages=False)
    assert found.outcome is oracle.Outcome.INCONCLUSIVE
    assert any("nothing rendered" in reason for reason in found.reasons)
