"""displacement/method.md, "Bad input": a ValueError that names the field, the value and what is allowed.

What a polygon, a camera and a light do not accept on their own is tested in tests/scene.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from ibr_ref import BasePolygon, Camera
from ibr_ref.displacement import Params, Scene, render
from ibr_ref.displacement.inputs import COMPARED
from tests.displacement.scenes import LIGHT, camera, noise, parallel_camera, square

NOT_NUMBERS = [
    (np.nan, "nan"),
    (np.inf, "inf"),
    (-np.inf, "-inf"),
    ("a", "'a'"),
    (None, "None"),
    ([1], "[1]"),
    (1j, "1j"),
]
NOT_WHOLE = [
    *NOT_NUMBERS,
    (2.5, "2.5"),
    (True, "True"),
    (False, "False"),
    ("10", "'10'"),
    (np.array([1, 2]), "array([1, 2])"),
]
WORDS = [("nothing", "'nothing'"), ("", "''"), (None, "None"), (1, "1"), (True, "True"), (["paper"], "['paper']")]

HUGE = (10**30, "1" + 30 * "0")

PARAMS = [
    *(("linear_steps", *row) for row in [*NOT_WHOLE, (0, "0"), (-1, "-1"), (2**24 + 1, "16777217"), HUGE]),
    *(("binary_steps", *row) for row in [*NOT_WHOLE, (-1, "-1"), (25, "25"), HUGE]),
    *(("steep_threshold", *row) for row in NOT_NUMBERS),
    *(("shadow_steps", *row) for row in [*NOT_WHOLE, (-1, "-1"), (2**20 + 1, "1048577")]),
    *(("shadow_bias", *row) for row in [*NOT_NUMBERS, (-1e-3, "-0.001")]),
    *(("lod_bias", *row) for row in [*NOT_NUMBERS, (-0.5, "-0.5"), (32.5, "32.5")]),
    *((field, *row) for field in ("min_steps", "max_steps") for row in [*NOT_WHOLE, (0, "0"), (2**16 + 1, "65537")]),
    *(("distance_layers", *row) for row in [*NOT_WHOLE, (0, "0"), (1025, "1025")]),
    ("min_steps", 51, "51"),
    *((field, *row) for field in ("interval", "faces", "depth", "method") for row in WORDS),
    ("interval", "Paper", "'Paper'"),
    ("method", "parallax", "'parallax'"),
]  # fmt: skip


def rejected(field: str, found: str, function: Any, *args: Any, **arguments: Any) -> None:
    """The call is rejected, with a message of one line: field: found ..., allowed: ..."""
    with pytest.raises(ValueError, match=rf"^{re.escape(field)}: found .*allowed: .") as error:
        function(*args, **arguments)
    assert found in str(error.value).split("allowed")[0]


@pytest.mark.parametrize(("field", "value", "found"), PARAMS, ids=[f"{field}={found}" for field, _, found in PARAMS])
def test_a_parameter_out_of_range_is_named(field: str, value: Any, found: str) -> None:
    rejected(field, found, Params, **{field: value})


@pytest.mark.parametrize(("n", "m"), [(2**24, 1), (2, 24), (2**18 + 1, 6), (3, 23)])
def test_a_lattice_above_2_to_the_24_is_named(n: int, m: int) -> None:
    rejected("linear_steps * 2^binary_steps", str(n * 2**m), Params, linear_steps=n, binary_steps=m)


@pytest.mark.parametrize(("n", "m"), [(2**24, 0), (1, 24), (2**18, 6), (1, 0)])
def test_a_lattice_of_2_to_the_24_is_accepted(n: int, m: int) -> None:
    assert Params(linear_steps=n, binary_steps=m).linear_steps == n


def test_whole_numbers_of_any_type_are_accepted() -> None:
    params = Params(linear_steps=20.0, binary_steps=np.int8(3), shadow_steps=np.uint16(4))  # type: ignore[arg-type]
    assert (params.linear_steps, params.binary_steps, params.shadow_steps) == (20, 3, 4)
    assert all(type(n) is int for n in (params.linear_steps, params.binary_steps, params.shadow_steps))


def test_a_numpy_bool_is_no_whole_number() -> None:
    rejected("linear_steps", "True", Params, linear_steps=np.True_)


@pytest.mark.parametrize("faces", ["base", "extended"])
def test_volume_needs_the_auxiliary_faces(faces: str) -> None:
    rejected("faces", f"'{faces}'", Params, interval="volume", faces=faces)


FLAT = square(noise(4, 4))
TILED = square(noise(4, 4), domain="repeat")


@pytest.mark.parametrize("faces", ["auxiliary", "extended"])
@pytest.mark.parametrize("method", ["protruded", "exact"])
def test_repeat_needs_the_base_face(faces: str, method: str) -> None:
    """Whichever polygon it is."""
    scene = Scene(polygons=[FLAT, TILED], camera=camera(), light=LIGHT)
    rejected("faces", f"'{faces}'", render, scene, Params(faces=faces, method=method))
    with pytest.raises(ValueError, match=r"polygons\[1\]"):
        render(scene, Params(faces=faces, method=method))


@pytest.mark.sampled(4)
@pytest.mark.parametrize("method", ["relief", "texture", *COMPARED])
def test_methods_on_the_base_alone_take_repeat_whatever_the_faces(method: str) -> None:
    render(Scene(polygons=[TILED], camera=camera(), light=LIGHT), Params(method=method))


@pytest.mark.parametrize("eye", [(0.4, 0.5, 0.25), (0.4, 0.5, 0.2), (2.0, -1.0, 0.1), (0.4, 0.3, -1.0)])
def test_the_extended_base_needs_an_eye_above_the_volume(eye: Any) -> None:
    """The volume is 0.25 high: an eye on its top is not above it."""
    view = camera(eye, target=(0.5, 0.45, 0.0), up=(0.1, 1.0, 0.2))
    rejected("faces", "'extended'", render, Scene(polygons=[FLAT], camera=view, light=LIGHT), Params(faces="extended"))


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (1.0, 0.0, -0.5)])
def test_the_extended_base_needs_lines_of_sight_that_go_down(direction: Any) -> None:
    view = parallel_camera(np.array((0.5, 0.5, 0.1)) + direction, target=(0.5, 0.5, 0.1))
    rejected("faces", "'extended'", render, Scene(polygons=[FLAT], camera=view, light=LIGHT), Params(faces="extended"))


SCENE: dict[str, Any] = {"polygons": [FLAT], "camera": camera(), "light": LIGHT}
SCENES = [
    ("polygons", [], "none"),
    ("polygons[1]", [FLAT, "a polygon"], "str"),
    ("polygons[0]", [None], "NoneType"),
    ("polygons", None, "None"),
    ("polygons", FLAT, "BasePolygon"),
    ("camera", None, "NoneType"),
    ("camera", LIGHT, "Light"),
    ("light", None, "NoneType"),
    ("light", (0, 0, 1), "tuple"),
    *(
        ("background", value, found)
        for value, found in [((0, 0, 1.5), "1.5"), ((0, -0.1, 0), "-0.1"), ((0, 0), "(0, 0)"), ((0, np.nan, 0), "nan"),
                             ("black", "'black'"), (0.5, "0.5")]
    ),
]  # fmt: skip


@pytest.mark.parametrize(("field", "value", "found"), SCENES, ids=[f"{field}={found}" for field, _, found in SCENES])
def test_a_scene_without_sense_is_named(field: str, value: Any, found: str) -> None:
    rejected(field, found, Scene, **{**SCENE, field.split("[")[0]: value})


PAGE: list[tuple[str, str, Any]] = [
    ("height_map[0, 1]", "1.5", lambda: square([[0.5, 1.5]])),
    ("height_map[1, 0]", "nan", lambda: square([[0.5], [np.nan]])),
    ("height_map.shape", "(0, 3)", lambda: square(np.zeros((0, 3)))),
    ("color_map.shape", "(2, 2)", lambda: square([[0.5]], color_map=np.zeros((2, 2)))),
    ("edge_v", "[2.0, 0.0, 0.0]", lambda: square([[0.5]], edge_v=(2, 0, 0))),
    ("height_scale", "0.0", lambda: square([[0.5]], height_scale=0.0)),
    ("linear_steps", "0", lambda: Params(linear_steps=0)),
    ("binary_steps", "-1", lambda: Params(binary_steps=-1)),
    ("linear_steps * 2^binary_steps", "33554432", lambda: Params(linear_steps=2**19, binary_steps=6)),
    ("shadow_steps", "-1", lambda: Params(shadow_steps=-1)),
    ("target", "[1.0, 2.0, 3.0]", lambda: camera((1, 2, 3), (1, 2, 3))),
    ("up", "[0.0, 0.0, 1.0]", lambda: camera((1, 2, 3), (1, 2, 0))),
    ("vertical_fov", "0.0", lambda: camera(vertical_fov=0.0)),
    ("far", "0.1", lambda: camera(near=0.1, far=0.1)),
    ("near", "0.0", lambda: camera(near=0.0)),
    ("view_height", "0.0", lambda: parallel_camera(view_height=0.0)),
    ("width", "0", lambda: camera(width=0)),
]


@pytest.mark.parametrize(("field", "found", "make"), PAGE, ids=[row[0] for row in PAGE])
def test_the_list_of_the_page(field: str, found: str, make: Any) -> None:
    rejected(field, found, make)


def test_positional_arguments_are_not_taken() -> None:
    for kind in (Params, Scene, BasePolygon, Camera):
        with pytest.raises(TypeError):
            kind(10)
