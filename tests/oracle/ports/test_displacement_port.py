"""The plain port, computing in float64, is the reference: all integers equal, all floats to 1e-9."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume

from ibr_ref import displacement, methods
from ibr_ref.contract import is_margin
from ibr_ref.displacement import Params, Scene
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.programs.displacement import PROGRAMS, Port
from ibr_ref.testing.displacement import REGIONS
from ibr_ref.testing.displacement import Drawn as Case
from ibr_ref.testing.displacement import drawn as cases
from tests import drawn
from tests.agreement import arrays_of
from tests.oracle.ports.displacement_scenes import SCENES

DOUBLE = Policy(float_bits=64)
TOLERANCE = 1e-9


def check_agreement(scene: Scene, params: Params, tolerance: float) -> None:
    """All arrays but the margins, by name, shape, type and value."""
    frame = arrays_of(displacement.render(scene, params))
    expected = {name: array for name, array in frame.items() if not is_margin(name)}
    found = Port(scene, params, DOUBLE, {}).render()
    assert set(found) == set(expected)
    for name, array in expected.items():
        assert (found[name].shape, found[name].dtype) == (array.shape, array.dtype), name
        if array.dtype.kind == "f":
            np.testing.assert_allclose(found[name], array, rtol=tolerance, atol=tolerance, err_msg=name)
        else:
            np.testing.assert_array_equal(found[name], array, err_msg=name)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", SCENES)
def test_port_agrees_with_the_reference(name: str, one_thread: None) -> None:
    check_agreement(*SCENES[name](), TOLERANCE)


def agree(case: Case) -> None:
    """Compare a drawn scene, if it is for the port: near planes next to the eye need a guard band.

    The drawn eyes are often on a border or graze it, where quotients magnify the rounding of another order.
    """
    camera = case.scene.camera
    assume(case.params.method in PROGRAMS and camera.near > 1e-4 * camera.far)
    check_agreement(case.scene, case.params, 100.0 * TOLERANCE)


@pytest.mark.parametrize("number", range(2 * len(REGIONS)))
def test_port_agrees_on_drawn_scenes(number: int, one_thread: None) -> None:
    drawn.run_scene(number, cases(REGIONS[number % len(REGIONS)]), agree)


SEARCHED = ("relief", "welsh", "mcguire", "tatarchuk", "cone", "relaxed_cone", "donnelly", "maximum_mipmap")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("method", SEARCHED)
@pytest.mark.parametrize("name", ["slope", "tiles", "lamp"])
def test_each_search_agrees_with_the_reference(method: str, name: str, one_thread: None) -> None:
    """Sheared, tilted, repeated, with self-shadow; the eye far away and near."""
    scene, params = SCENES[name]()
    check_agreement(scene, replace(params, method=method, faces="base", interval="paper", lod_bias=0.0), TOLERANCE)


@pytest.mark.parametrize("number", range(2 * len(SEARCHED)))
def test_each_search_agrees_on_drawn_scenes(number: int, one_thread: None) -> None:
    method = SEARCHED[number // 2]

    def searched(case: Case) -> None:
        params = replace(case.params, method=method, interval="paper", lod_bias=0.0)
        agree(replace(case, params=params))

    drawn.run_scene(number, cases(REGIONS[number % len(REGIONS)]), searched)


@pytest.mark.parametrize("method", ["exact", "texture"])
def test_other_systems_are_refused(method: str) -> None:
    scene, _ = SCENES["box"]()
    with pytest.raises(ValueError, match=f"method: found '{method}', allowed: protruded | "):
        Port(scene, Params(method=method), DOUBLE, {})


def test_other_mip_levels_are_refused() -> None:
    scene, _ = SCENES["box"]()
    with pytest.raises(ValueError, match=r"lod_bias: found 1\.0, allowed: 0 in a case of mcguire"):
        Port(scene, Params(method="mcguire"), DOUBLE, {})


def test_the_judged_systems_have_programs() -> None:
    assert set(methods.named("displacement").judged[1]) == set(PROGRAMS)
