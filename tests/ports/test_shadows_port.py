"""The GLSL port of shadows on a real OpenGL, judged by the oracle: all that it does is legal, and a fault is noticed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import ibr_ref
from ibr_ref import shadows
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.referees.shadows import ShadowsReferee

moderngl = pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")

from tests.ports.described import described  # noqa: E402
from tests.ports.gl import Frame  # noqa: E402
from tests.ports.shadows import Port  # noqa: E402

REFEREE = ShadowsReferee()
Arrays = dict[str, np.ndarray]
SIZE, ROWS, COLUMNS = 32, 5, 3

CASES: dict[str, dict[str, Any]] = {
    "dissolve": {},
    "nearest": {"policy": "nearest"},
    "five": {"light_samples": 5},
    "nine, unorm8": {"light_samples": 9, "accumulation": "unorm8"},
    "coverage": {"map_samples": 3},
    "depth": {"content": "depth"},
    "depth, nearest, five": {"content": "depth", "policy": "nearest", "light_samples": 5},
    "depth, pcf": {"content": "depth", "pcf": True, "bias": 0.02},
    "depth, quantized": {"content": "depth", "quantize": 8, "bias": 0.02},
    "depth, quantized, pcf": {"content": "depth", "quantize": 8, "pcf": True, "bias": 0.02},
    "direct": {"method": "direct"},
    "direct, five": {"method": "direct", "light_samples": 5},
    "direct, depth": {"method": "direct", "content": "depth", "bias": 0.01},
}


@pytest.fixture(scope="module")
def port() -> Iterator[Port]:
    try:
        yield Port()
    except Exception as error:
        pytest.skip(f"no headless OpenGL 4.5: {error}")


def box() -> ibr_ref.Mesh:
    corners = np.array([(x, y, z) for x in (-0.375, 0.25) for y in (-0.25, 0.375) for z in (-0.25, 0.25)])
    quads = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    colors = np.random.default_rng(3).integers(0, 256, (8, 3)) / 255.0
    return ibr_ref.Mesh(vertices=corners, triangles=np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]), color=colors)


def square(half: float, z: float) -> ibr_ref.Mesh:
    corners = [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)]
    return ibr_ref.Mesh(vertices=corners, triangles=[(0, 1, 2), (0, 2, 3)], color=(0.5, 0.6, 0.7))


def on_the_raster(samples: int) -> shadows.Scene:
    """All corners, of the control meshes too, are multiples of 1/256 pixel: nothing is snapped."""
    reach = 0.5 if samples == 1 else 0.375  # the light's samples add 0.125
    return shadows.Scene(
        receivers=[square(1.75, -1.0)],
        caster=box(),
        offset_range=((-reach, reach), (-reach, reach)),
        offset=(0.1875, -0.3125),
        light=shadows.AreaLight(
            position=(-1.0, 0.75, 3.0),
            target=(0.0, 0.0, -1.0),
            vertical_fov=60.0,
            near=1.0,
            far=8.0,
            half_edges=((0.1875, 0, 0), (0, 0.1875, 0)),
        ),
        camera=ibr_ref.Camera.orthographic(
            eye=(0, 0, 6), target=(0, 0, 0), up=(0, 1, 0), view_height=4.0, near=1, far=9, width=40, height=32
        ),
        ambient=0.25,
        background=(0.1, 0.2, 0.3),
    )


def anywhere(samples: int) -> shadows.Scene:
    """Perspective, oblique axes, a tilted light, a wall: nothing is on a raster."""
    wall = ibr_ref.Mesh(
        vertices=[(1.2, -1.5, -1.2), (1.2, 1.5, -1.2), (1.4, 1.5, 1.6), (1.4, -1.5, 1.6)],
        triangles=[(0, 2, 1), (0, 3, 2)],
        color=np.random.default_rng(5).random((4, 3)),
    )
    axes = np.array([(0.9, 0.1, 0.2), (-0.3, 1.2, 0.1)])
    return shadows.Scene(
        receivers=[square(2.0, -1.1), wall],
        caster=box(),
        offset_axes=axes,
        offset_range=((-0.1, 0.5), (0.0, 0.45)),
        offset=(0.17, 0.23),
        light=shadows.AreaLight(
            position=(-1.5, 0.9, 3.2),
            target=(0.1, 0.0, -1.0),
            up=(0.3, 1.0, 0.1),
            vertical_fov=55.0,
            near=0.9,
            far=9.0,
            half_edges=0.2 * axes,
        ),
        camera=ibr_ref.Camera.look_at(
            eye=(-0.6, -3.0, 3.2),
            target=(0, 0, -0.4),
            up=(0, 0, 1),
            vertical_fov=50.0,
            near=0.2,
            far=20,
            width=44,
            height=32,
        ),
        ambient=0.2,
        background=(0.1, 0.2, 0.3),
    )


SCENES = {"on the raster": on_the_raster, "anywhere": anywhere}


def moved_controls() -> np.ndarray:
    """Nine grids, inner points moved by multiples of 1/128."""
    grid = np.stack(np.meshgrid(np.linspace(0, 1, COLUMNS), np.linspace(0, 1, ROWS)), axis=-1)
    controls = np.broadcast_to(grid, (3, 3, ROWS, COLUMNS, 2)).copy()
    controls[:, :, 1:-1, 1:-1] += np.random.default_rng(7).integers(-5, 6, (3, 3, ROWS - 2, COLUMNS - 2, 2)) / 128.0
    return controls


@cache
def case(scene: str, name: str) -> Case:
    """A scene with parameters, and the maps of it if it has some."""
    params = shadows.Params(map_size=SIZE, rows=ROWS, columns=COLUMNS, **CASES[name])
    described = SCENES[scene](params.light_samples)
    warps = params.method == "warp"
    return Case(
        name="port",
        method="shadows",
        kind="typical",
        about="",
        profile="gl",
        scene=described,
        params=params,
        inputs={"maps": shadows.prepare(described, params, controls=moved_controls())} if warps else {},
    )


def drawn(port: Port, given: Case, **options: Any) -> Frame:
    """The port's frame of an exported case."""
    exported = described("shadows", given.scene, given.params, **given.inputs)
    return port.render(exported.scene, exported.params, **options)


def handed(frame: Frame) -> Arrays:
    """What it hands in: the names of the contract alone."""
    stages = {name: array for name, array in frame.stages.items() if not name.startswith("raster.")}
    return {**stages, "color": frame.color, "depth": frame.depth}


def judged(given: Case, frame: Frame) -> list[Judgement]:
    arrays, device = handed(frame), PROFILES["gl"]
    picture = {"color": frame.color, "depth": frame.depth}
    return [*REFEREE.judge_stages(given, device, arrays), REFEREE.judge_image(given, device, picture)]


def wrong(found: list[Judgement]) -> list[tuple[str, list[list[int]]]]:
    return [(j.stage, np.argwhere(j.wrong)[:3].tolist()) for j in found if j.wrong.any()]


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("scene", SCENES)
def test_every_stage_is_legal(port: Port, scene: str, name: str) -> None:
    given = case(scene, name)
    found = judged(given, drawn(port, given))
    assert wrong(found) == []
    assert {"warp", "depth", "project", "accumulate", "resolve", "image"} == {j.stage for j in found}
    for judgement in found:
        # Coarse maps and bytes leave more open than the official cases do.
        assert judgement.undecided.mean() <= (0.2 if given.params.quantize else 0.05), judgement.stage
    assert 0.01 < (given.frame.stages["accumulate.shadow"] > 0.2).mean() < 0.8, "hardly a shadow: the test says nothing"


def test_the_top_left_rule_where_edges_meet_pixel_centres(port: Port) -> None:
    """Seen from above the box's edges run through centres: whoever covers them is the same, so the depth is."""
    given = case("on the raster", "dissolve")
    frame = drawn(port, given)
    assert abs(given.frame.depth - frame.depth).max() < 1e-5
    caster = frame.depth < 0.7  # the floor is at 3/4
    columns = [caster.any(axis=axis).nonzero()[0] for axis in (0, 1)]
    assert [(int(each[0]), int(each[-1])) for each in columns] == [(18, 22), (15, 19)]


@pytest.mark.parametrize("content", ["mask", "depth"])
@pytest.mark.parametrize("scene", SCENES)
def test_nine_maps_are_legal(port: Port, scene: str, content: str) -> None:
    given = case(scene, "dissolve" if content == "mask" else "depth")
    exported = described("shadows", given.scene, given.params, **given.inputs)
    maps = port.maps(exported.scene, exported.params)
    (found,) = REFEREE.judge_stages(given, PROFILES["gl"], {"maps.image": maps})
    assert wrong([found]) == []
    assert found.undecided.mean() < 0.1


@pytest.mark.parametrize("name", ["dissolve", "nine, unorm8", "depth", "direct"])
def test_the_timed_variant_draws_nearly_the_same_picture(port: Port, name: str) -> None:
    """Bytes and the sampler's own filter: a mix of two rounded twice, and 8 bits of colour, light and result."""
    given = case("anywhere", name)
    staged, timed = drawn(port, given), drawn(port, given, stages=False)
    assert timed.stages == {}
    np.testing.assert_array_equal(staged.depth, timed.depth)
    assert abs(staged.color - timed.color).max() < 0.03
    assert abs(staged.color - timed.color).mean() < 0.003


@pytest.mark.parametrize("fault", ["controls", "offset", "ambient", "light"])
def test_a_broken_port_is_noticed(port: Port, fault: str) -> None:
    """The port with controls, an offset, a shade and a light that are slightly off: none may pass."""
    given = case("on the raster", "dissolve")
    maps, scene = given.inputs["maps"], given.scene
    controls = moved_controls()
    controls[1, 1, 2, 1, 0] += 1.0 / 128.0
    changed = {
        "controls": (scene, replace(maps, controls=controls), "warp"),
        "offset": (replace(scene, offset=(0.1885, -0.3125)), maps, "warp"),
        "ambient": (replace(scene, ambient=0.251), maps, "resolve"),
        "light": (replace(scene, light=replace(scene.light, target=(0.001, 0.0, -1.0))), maps, "project"),
    }
    broken, its_maps, stage = changed[fault]
    assert wrong(judged(given, drawn(port, given))) == []
    found = judged(given, drawn(port, replace(given, scene=broken, inputs={"maps": its_maps})))
    assert wrong(found)[0][0] == stage


def test_what_is_not_ported_is_refused(port: Port) -> None:
    with pytest.raises(ValueError, match="method = 'grid'"):
        port.prepare(on_the_raster(1), shadows.Params(method="grid"))
