"""The GLSL port on a real OpenGL, judged by the oracle: nothing of what it draws is wrong."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from ibr_ref.oracle.device import PROFILES
from tests.oracle.displacement.drawn import REFEREE, SMALL, case, wrong

moderngl = pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")

from ibr_ref.ports.described import described  # noqa: E402
from ibr_ref.ports.glsl.displacement import Port  # noqa: E402

COVERED = (
    "box",
    "mapped",
    "dusk",
    "slope",
    "city",
    "lamp",
    "filtered",
    "loose",
    "planes",
    "low",
    "crossing",
    "borders",
)
"""The cases of the paper's interval on bounded maps, which is what that port draws."""
BELOW = ("relief", "parallax", "steep", "occlusion", "cone", "relaxed", "distance", "quadtree")
"""Those of the searches below the polygon."""


@pytest.fixture(scope="module")
def port() -> Iterator[Port]:
    try:
        yield Port()
    except Exception as error:
        pytest.skip(f"no headless OpenGL 4.5: {error}")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", [f"displacement-{name}" for name in COVERED])
def test_the_port_passes(port: Port, name: str) -> None:
    assert name in SMALL
    what = case(name)
    frame = port.render(what.scene, what.params)
    arrays = {**frame.stages, "color": frame.color, "depth": frame.depth}
    assert not wrong(REFEREE.judge_stages(what, PROFILES["gl"], arrays))
    if name.removeprefix("displacement-") in COVERED[::3]:
        assert not wrong([REFEREE.judge_image(what, PROFILES["gl"], {"color": frame.color, "depth": frame.depth})])


@pytest.mark.parametrize("name", [f"displacement-{name}" for name in BELOW])
def test_the_port_passes_below_the_polygon(port: Port, name: str) -> None:
    what = case(name)
    given = described("displacement", what.scene, what.params)
    frame = port.render(given.scene, given.params)
    arrays = {**frame.stages, "color": frame.color, "depth": frame.depth}
    assert (arrays["march.hit_index"] >= 0).any()
    assert not wrong(REFEREE.judge_stages(what, PROFILES["gl"], arrays))


def test_the_port_with_one_step_more_fails(port: Port) -> None:
    what = case("displacement-box")
    frame = port.render(what.scene, type(what.params)(linear_steps=what.params.linear_steps + 1))
    found = wrong(REFEREE.judge_stages(what, PROFILES["gl"], {**frame.stages, "color": frame.color}))
    assert found[0][0] == "march"
    assert wrong([REFEREE.judge_image(what, PROFILES["gl"], {"color": np.asarray(frame.color)})])
