"""The GLSL port of shadows on scenes beside the built-in cases, judged by the oracle; and the maps that it renders."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import ibr_ref
from ibr_ref import oracle, shadows
from ibr_ref.oracle import Case, Outcome, Verdict

SIZE, ROWS, COLUMNS = 32, 5, 3

CASES: dict[str, dict[str, Any]] = {
    "dissolve": {},
    "nearest": {"policy": "nearest"},
    "projective": {"interpolation": "projective"},
    "projective, nearest, five": {"interpolation": "projective", "policy": "nearest", "light_samples": 5},
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


def case(scene: str, name: str) -> Case:
    """A scene with parameters, and the maps of it if it has some."""
    params = shadows.Params(map_size=SIZE, rows=ROWS, columns=COLUMNS, **CASES[name])
    given = SCENES[scene](params.light_samples)
    inputs = {"maps": shadows.prepare(given, params, controls=moved_controls())} if params.method == "warp" else {}
    return Case(
        name=f"{scene}; {name}", method="shadows", kind="typical", about="", profile="gl", scene=given, params=params,
        inputs=inputs,
    )  # fmt: skip


def verdict(given: Case, drawn: Any) -> Verdict:
    """On a frame."""
    submission = oracle.submission_from_arrays(given, color=drawn.color, depth=drawn.depth, stages=drawn.stages)
    return oracle.check(given, submission, profile="gl").verdict


def draw(given: Case, device: Any) -> Any:
    """The port's frame of an exported case."""
    pytest.importorskip("moderngl")
    from ibr_ref.ports.described import described
    from ibr_ref.ports.glsl.shadows import Port

    exported = described("shadows", given.scene, given.params, **given.inputs)
    return Port(device).render(exported.scene, exported.params)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("scene", SCENES)
def test_every_stage_is_legal(device: Any, scene: str, name: str) -> None:
    given = case(scene, name)
    found = verdict(given, draw(given, device))
    assert found.outcome is Outcome.PASS, found.words()
    assert found.undecided_share is not None
    assert found.undecided_share < 0.15
    shadow = given.frame.stages["accumulate.shadow"] > 0.2
    assert 0.01 < shadow.mean() < 0.8, "hardly a shadow: the test says nothing"


@pytest.mark.long
@pytest.mark.parametrize("content", ["mask", "depth"])
@pytest.mark.parametrize("samples", [1, 3])
def test_the_nine_maps_are_legal(device: Any, content: str, samples: int) -> None:
    """A port that prepares the maps itself, at the places that it is given."""
    from ibr_ref.ports.described import described
    from ibr_ref.ports.glsl.gl import create_device
    from ibr_ref.ports.glsl.shadows import Port

    params = shadows.Params(map_size=SIZE, rows=ROWS, columns=COLUMNS, content=content, map_samples=samples)
    given = case("anywhere", "dissolve")
    maps = shadows.prepare(given.scene, params, controls="identity")
    given = replace(given, params=params, inputs={"maps": maps})
    exported = described("shadows", given.scene, given.params, **given.inputs)
    other = create_device()  # whose context is current from then on
    drawn = Port(device).maps(exported.scene, exported.params)
    other.ctx.release()
    for images, right in ((drawn, True), (drawn[::-1], False)):
        submission = oracle.submission_from_arrays(given, stages={"maps.image": images})
        (stage,) = oracle.check(given, submission, profile="gl").verdict.stages
        assert (stage.arrays, stage.right) == (("maps.image",), right)


def test_a_broken_port_is_noticed(device: Any) -> None:
    """Controls, an offset and a light that are slightly off: none may pass."""
    given = case("on the raster", "dissolve")
    maps = given.inputs["maps"]
    moved = moved_controls()
    moved[1, 1, 2, 1, 0] += 1.0 / 128.0
    turned = replace(given.scene.light, target=(0.001, 0.0, -1.0))
    for wrong in (
        replace(given, inputs={"maps": replace(maps, controls=moved)}),
        replace(given, scene=replace(given.scene, offset=(0.1885, -0.3125))),
        replace(given, scene=replace(given.scene, ambient=0.251)),
        replace(given, scene=replace(given.scene, light=turned)),
    ):
        assert verdict(given, draw(wrong, device)).outcome is Outcome.FAIL
