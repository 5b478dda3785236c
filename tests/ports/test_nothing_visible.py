"""The sample ports on views in which nothing is seen: what is clipped, beside the picture, or of no width."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from ibr_ref import oracle, splatting
from ibr_ref.oracle.cases import Case
from ibr_ref.ports.drawing import SAMPLES, Drawer
from tests.oracle.test_nothing_visible import CASES, VIEWS, points

pytestmark = pytest.mark.usefixtures("one_thread")


def without_width() -> Case:
    """Splats in view that the law makes no wider than nothing; they are not dropped."""
    case = points(VIEWS["beside"])
    camera = case.scene.images[0].camera
    return replace(
        case, scene=replace(case.scene, camera=camera), params=splatting.Params(max_width=0.0, min_width=0.0)
    )


MADE: dict[str, Callable[[], Case]] = {
    **{f"{method}, {view}": partial(make, VIEWS[view]) for method, make in CASES.items() for view in VIEWS},
    "splatting, no width": without_width,
}


@pytest.fixture(scope="module", params=["glsl", "wgsl"])
def drawer(request: pytest.FixtureRequest) -> Iterator[Drawer]:
    try:
        found = SAMPLES[request.param](None)
    except ValueError as error:
        pytest.skip(str(error))
    yield found
    found.close()


@pytest.mark.parametrize("name", MADE)
def test_a_sample_port_is_right(name: str, drawer: Drawer, tmp_path: Path) -> None:
    case = MADE[name]()
    oracle.export(case, tmp_path / "case")
    drawer.into(tmp_path / "case", tmp_path / "out")
    verdict = oracle.check(case, oracle.load_submission(tmp_path / "out", case)).verdict
    assert verdict.outcome is oracle.Outcome.PASS, verdict.words()
