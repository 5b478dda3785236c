"""shadows/method.md, "Bad input": a ValueError that names the field, the value and what is allowed."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from ibr_ref import shadows
from ibr_ref.shadows import AreaLight, Params, Scene, SoftParams, prepare, render, render_soft
from tests.shadows.plates import regular_grid
from tests.shadows.scenes import box, light, params, plate, scene

NOT_NUMBERS = [(np.nan, "nan"), (np.inf, "inf"), ("a", "'a'"), (None, "None"), ([1], "[1]"), (1j, "1j")]
NOT_WHOLE = [*NOT_NUMBERS, (2.5, "2.5"), (True, "True"), ("10", "'10'")]
WORDS = [("nothing", "'nothing'"), (None, "None"), (1, "1"), (["mask"], "['mask']")]
NOT_BOOL = [(1, "1"), ("yes", "'yes'"), (None, "None")]


def rejected(field: str, found: str, function: Any, *args: Any, **arguments: Any) -> str:
    """The call is rejected, with a message of one line: field: found ..., allowed: ..."""
    with pytest.raises(ValueError, match=rf"^{re.escape(field)}: found .*allowed: .") as error:
        function(*args, **arguments)
    message = str(error.value)
    assert found in message.split("allowed")[0]
    assert "\n" not in message
    return message


PARAMS = [
    *(("map_size", *row) for row in [*NOT_WHOLE, (7, "7"), (4097, "4097")]),
    *((field, *row) for field in ("rows", "columns") for row in [*NOT_WHOLE, (1, "1"), (257, "257")]),
    *(("map_samples", *row) for row in [*NOT_WHOLE, (0, "0"), (16, "16")]),
    *(("grid_size", *row) for row in [*NOT_WHOLE, (1, "1")]),
    *((field, *row) for field in ("search_points", "filter_points") for row in [*NOT_WHOLE, (0, "0"), (4097, "4097")]),
    *(
        (field, *row)
        for field in ("content", "policy", "accumulation", "method", "grid_storage")
        for row in WORDS
    ),
    *((field, *row) for field in ("pcf", "grid_mix") for row in NOT_BOOL),
    *(("quantize", *row) for row in [(7, "7"), (8.0, "8.0"), (True, "True"), ("8", "'8'")]),
    *(("bias", *row) for row in [*NOT_NUMBERS, (-1e-3, "-0.001")]),
    *(("grid_threshold", *row) for row in [*NOT_NUMBERS, (-0.1, "-0.1"), (1.5, "1.5")]),
    *(("light_samples", *row) for row in [(0, "0"), (2, "2"), (-1, "-1"), (True, "True"), (None, "None"), (5.0, "5.0")]),
    *(("light_samples", *row) for row in [("nine", "'nine'"), ([[1, 2, 3], [1]], "[[1, 2, 3], [1]]")]),
    *(("light_samples.shape", *row) for row in [([], "(0,)"), ([1, 2, 3], "(3,)"), (np.zeros((0, 3)), "(0, 3)")]),
    ("light_samples.shape", np.zeros((2, 2)), "(2, 2)"),
    ("light_samples[1]", [(0, 0, 4), (0, np.nan, 4)], "nan"),
]  # fmt: skip


@pytest.mark.parametrize(("field", "value", "found"), PARAMS, ids=[f"{field}={found}" for field, _, found in PARAMS])
def test_a_parameter_out_of_range_is_named(field: str, value: Any, found: str) -> None:
    rejected(field, found, Params, **{re.split(r"[.\[]", field)[0]: value})


def test_sizes_that_are_only_together_too_large() -> None:
    rejected("map_size * map_samples", "40960", Params, map_size=4096, map_samples=10)
    rejected("grid_size^2 maps of map_size^2", "17179869184 bytes", Params, method="grid", map_size=4096)


SOFT = [
    *(("method", *row) for row in [*WORDS, ("warp", "'warp'")]),
    *(("rays", *row) for row in [*NOT_WHOLE, (0, "0"), (65537, "65537")]),
    *(("map_size", *row) for row in [*NOT_WHOLE, (7, "7"), (4097, "4097")]),
    *(("map_samples", *row) for row in [*NOT_WHOLE, (0, "0"), (16, "16")]),
    *(("receiver_planes", *row) for row in [*NOT_WHOLE, (0, "0"), (65, "65")]),
]  # fmt: skip


@pytest.mark.parametrize(("field", "value", "found"), SOFT, ids=[f"{field}={found}" for field, _, found in SOFT])
def test_a_soft_parameter_out_of_range_is_named(field: str, value: Any, found: str) -> None:
    rejected(field, found, SoftParams, **{field: value})


def test_soft_maps_that_are_only_together_too_large() -> None:
    rejected("map_size * map_samples", "40960", SoftParams, map_size=4096, map_samples=10)


def test_a_light_beside_the_caster_throws_no_single_map() -> None:
    beside = scene(light=light(position=(0.0, 1.5, 0.1), target=(0.0, 0.0, 0.0), up=(0, 0, 1)))
    rejected("light.position", "0.1", render_soft, beside, SoftParams(method="convolution"))
    rejected("light.position", "0.1", render, beside, Params(method="pcss"))


def test_a_light_inside_the_caster_casts_no_rays() -> None:
    inside = scene(light=light(position=(0.2, -0.1, 0.1), target=(0.0, 0.0, -1.0)))
    rejected("light.position", "0.1", render_soft, inside, SoftParams())


SCENES = [
    ("receivers", (), "none"),
    ("receivers", plate(), "Mesh"),
    ("receivers", None, "NoneType"),
    ("receivers[1]", [plate(), 1], "int"),
    ("caster", None, "NoneType"),
    ("light", None, "NoneType"),
    ("camera", 3, "int"),
    ("offset_axes", ((1, 0, 0), (2, 0, 0)), "[2.0, 0.0, 0.0]"),
    ("offset_axes", ((0, 0, 0), (0, 1, 0)), "[0.0, 0.0, 0.0]"),
    ("offset_axes", ((1, 0), (0, 1)), "((1, 0), (0, 1))"),
    ("offset_axes", ((np.nan, 0, 0), (0, 1, 0)), "nan"),
    ("offset_range", ((1, 1), (0, 1)), "[1.0, 1.0]"),
    ("offset_range", ((0, 1), (1, 0)), "[1.0, 0.0]"),
    ("offset_range", (0, 1), "(0, 1)"),
    ("offset", (0.2, 0.6), "(0.2, 0.6)"),
    ("offset", (-0.51, 0.0), "-0.51"),
    ("offset", (np.nan, 0.0), "nan"),
    ("offset", (0, 0, 0), "(0, 0, 0)"),
    ("ambient", -0.1, "-0.1"),
    ("ambient", 1.1, "1.1"),
    ("background", (0, 0, 2), "2.0"),
    ("light.half_edges[1]", light(half_edges=((0.2, 0, 0), (0, 0.2, 0.1))), "[0.0, 0.2, 0.1]"),
]


@pytest.mark.parametrize(("field", "value", "found"), SCENES, ids=[f"{field}-{found}" for field, _, found in SCENES])
def test_a_scene_that_is_not_one_is_named(field: str, value: Any, found: str) -> None:
    rejected(field, found, scene, **{re.split(r"[.\[]", field)[0]: value})


def test_an_offset_out_of_range_prints_the_range() -> None:
    message = rejected("offset", "(0.75, 0.0)", scene, offset=(0.75, 0.0))
    assert "x from -0.5 to 0.5 and y from -0.5 to 0.5" in message


LIGHTS = [
    ("position", (0, 0, np.nan), "nan"),
    ("target", (0, 0, 4), "[0.0, 0.0, 4.0]"),
    ("up", (0, 0, 1), "[0.0, 0.0, 1.0]"),
    ("vertical_fov", 0.0, "0.0"),
    ("vertical_fov", 180.0, "180.0"),
    ("vertical_fov", None, "None"),
    ("near", 0.0, "0.0"),
    ("far", 1.0, "1.0"),
    ("half_edges", ((1, 0, 0),), "((1, 0, 0),)"),
    ("half_edges", ((np.inf, 0, 0), (0, 1, 0)), "inf"),
]


@pytest.mark.parametrize(("field", "value", "found"), LIGHTS, ids=[f"{field}-{found}" for field, _, found in LIGHTS])
def test_a_light_that_is_not_one_is_named(field: str, value: Any, found: str) -> None:
    rejected(field, found, light, **{field: value})


# --- Only together ---------------------------------------------------------------------------------------------------


def test_a_light_inside_the_caster() -> None:
    inside = scene(caster=box(4.0))
    for function in (render, prepare):
        message = rejected("light.position", "[0.0, 0.0, 4.0]", function, scene(caster=box(4.5)), params())
        assert "outside the caster" in message
    rejected("light.position", "[0.0, 0.0, 4.0]", render, inside, params())  # on its surface


def test_only_one_sample_inside_the_caster_is_enough() -> None:
    """The cube's edge is between the centre and the sample at (-0.2, 0.1) beside it."""
    beside = light(position=(0.7, -0.1, 0.0), target=(0.7, 0.0, -1.0), half_edges=((0.3, 0, 0), (0, 0.3, 0)))
    close = scene(light=beside)
    render(close, params(method="direct"))
    rejected("light.position", "[0.5, -0.3", render, close, params(method="direct", light_samples=9))
    rejected("light_samples[1]", "[0.3, 0.0, 0.0]", render, close, params(light_samples=[(0.7, 0, 0), (0.3, 0, 0)]))


def test_prepared_places_under_the_light_count_too() -> None:
    """The object never stands where the light is, but may on its way: the maps could not be made."""
    low = scene(light=light(position=(-0.4, 0.0, 0.1), target=(-0.4, 0.0, -1.0)), offset=(0.5, 0.0))
    render(low, params(method="direct"))
    assert "at offset" in rejected("light.position", "[-0.4, 0.0, 0.1]", prepare, low, params())


def test_a_light_on_a_receiver() -> None:
    message = rejected("light.position", "4.0", render, scene(receivers=[plate(6.0, -1.0), plate(1.0, 4.0)]), params())
    assert "receivers[1] (it is on triangle 0)" in message
    render(scene(receivers=[plate(6.0, -1.0), plate(1.0, 4.01)]), params(method="direct"))


def test_positions_out_of_the_lights_plane() -> None:
    message = rejected("light_samples[0]", "[0.0, 0.1, 4.5]", render, scene(), params(light_samples=[(0, 0.1, 4.5)]))
    assert "(0.0, 0.0, 4.0)" in message


def controls(**points: float) -> Any:
    grids = np.broadcast_to(regular_grid(5, 4), (3, 3, 5, 4, 2)).copy()
    for name, value in points.items():
        grids[1, 2, 2, 1, "uv".index(name)] = value
    return grids


def test_controls() -> None:
    rejected("controls.shape", "(5, 4, 2)", prepare, scene(), params(), controls=regular_grid(5, 4))
    rejected("controls.shape", "(3, 3, 5, 4, 2)", prepare, scene(), params(rows=6), controls=controls())
    rejected("controls", "'by hand'", prepare, scene(), params(), controls="by hand")
    rejected("controls", "None", prepare, scene(), params(), controls=None)
    rejected("controls[1, 2, 2, 1, 0]", "nan", prepare, scene(), params(), controls=controls(u=np.nan))
    rejected("controls[1, 2, 2, 1, 1]", "-0.25", prepare, scene(), params(), controls=controls(v=-0.25))
    message = rejected("controls[1, 2]", "folded", prepare, scene(), params(), controls=controls(u=0.9))
    assert "row 1, column 1" in message
    rejected("controls[1, 2]", "without an area", prepare, scene(), params(), controls=controls(u=2 / 3, v=0.75))


def test_grids_that_fold_only_between_the_maps() -> None:
    """A grid and the same turned by half: in the middle all points meet."""
    turned = np.broadcast_to(regular_grid(2, 2), (3, 3, 2, 2, 2)).copy()
    turned[:, 2] = turned[:, 2, ::-1, ::-1]
    small = params(rows=2, columns=2)
    middle = scene(offset=(0.25, 0.0))
    maps = prepare(middle, small, controls=turned)
    message = rejected(
        "controls (warp.row_grids[0] of light sample 0)", "without an area", render, middle, small, maps=maps
    )
    assert "cell at row 0, column 0" in message
    render(scene(offset=(-0.25, 0.0)), small, maps=maps)


def test_maps_that_do_not_fit() -> None:
    here, small = scene(), params()
    maps = prepare(here, small)
    for field, other in (("map_size", 32), ("content", "depth"), ("map_samples", 2), ("rows", 6), ("columns", 5)):
        rejected(f"maps ({field})", "", render, here, params(**{field: other}), maps=maps)
    elsewhere = scene(light=light(position=(0.1, 0.0, 4.0)))
    for other in (scene(caster=box(0.41)), scene(offset_axes=((1, 0, 0), (0, 2, 0))), elsewhere):
        rejected("maps", "another caster", render, other, small, maps=maps)
    rejected("maps", "(-0.", render, scene(offset=(-0.5, 0.0)), params(light_samples=9), maps=maps)
    rejected("maps", "Maps", render, here, params(method="direct"), maps=maps)
    rejected("maps", "Maps", render, here, params(method="grid"), maps=maps)
    grid = shadows.prepare_grid(here, params(method="grid", grid_size=2))
    rejected("maps", "MapGrid", render, here, small, maps=grid)
    rejected("maps (grid_size)", "2", render, here, params(method="grid", grid_size=3), maps=grid)
    rejected(
        "maps (grid_storage)", "raw", render, here, params(method="grid", grid_size=2, grid_storage="haar"), maps=grid
    )


def test_positional_arguments_are_not_taken() -> None:
    for kind in (Params, Scene, AreaLight):
        with pytest.raises(TypeError):
            kind(10)
