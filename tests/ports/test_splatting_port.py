"""The GLSL port of splatting on a real OpenGL, judged by the oracle: all that it does is legal, and a fault is noticed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import ibr_ref
from ibr_ref import splatting
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.referees.splatting import SplattingReferee

moderngl = pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")

from ibr_ref.ports.described import described  # noqa: E402
from ibr_ref.ports.glsl.gl import Frame  # noqa: E402
from ibr_ref.ports.glsl.splatting import Port  # noqa: E402

REFEREE = SplattingReferee()
LIGHTS = {
    "baked": None,
    "point": ibr_ref.Light(position=(2.0, -1.5, 2.5), ambient=0.1, diffuse=0.7, specular=0.4, exponent=9),
    "direction": ibr_ref.Light(direction=(1.0, 0.5, 0.7)),
}


@pytest.fixture(scope="module")
def port() -> Iterator[Port]:
    try:
        yield Port()
    except Exception as error:
        pytest.skip(f"no headless OpenGL 4.5: {error}")


def reference_camera(kind: str, eye: tuple[float, float, float], width: int, height: int) -> ibr_ref.Camera:
    if kind == "orthographic":
        return ibr_ref.Camera.orthographic(
            eye=eye, target=(0, 0, 0), view_height=2.0, near=0.5, far=9, width=width, height=height
        )
    camera = ibr_ref.Camera.look_at(eye=eye, target=(0, 0, 0), near=0.5, far=9, width=width, height=height)
    if kind == "perspective":
        return camera
    skewed = np.add(camera.intrinsics, [[0.0, 0.7, 1.3], [0.0, 1.0, -0.6], [0.0, 0.0, 0.0]])
    view = camera.view_from_world
    return ibr_ref.Camera.calibrated(
        intrinsics=skewed, rotation=view[:3, :3], translation=view[:3, 3], near=0.5, far=9, width=width, height=height
    )


def reference(
    kind: str, eye: tuple[float, float, float], *, holes: float = 0.0, width: int = 30, height: int = 22
) -> ibr_ref.DepthImage:
    """Waves around the world's origin, some 3 units before the camera, in colours and with holes by a fixed seed."""
    random = np.random.default_rng(width)
    rows, columns = np.indices((height, width))
    depth = 3.0 + 0.3 * np.sin(rows / 3.0) * np.cos(columns / 4.0) + random.uniform(0.0, 0.05, (height, width))
    color = random.integers(0, 256, (height, width, 3)) / 255.0
    mask = random.random((height, width)) >= holes
    return ibr_ref.DepthImage(color=color, depth=depth, mask=mask, camera=reference_camera(kind, eye, width, height))


def scene(view: str = "perspective", light: str = "baked") -> splatting.Scene:
    """References by cameras of three kinds and one without a point; the view's near and far planes cut some points off."""
    images = [
        reference("perspective", (3.0, 0.0, 0.5), holes=0.3),
        reference("calibrated", (2.9, 0.6, 0.4), width=26),
        reference("perspective", (3.0, 0.0, 0.0), holes=1.0, width=8),
        reference("orthographic", (2.8, -0.6, 0.3), holes=0.1, width=24),
    ]
    options = {"eye": (3.2, 0.1, 0.3), "target": (0.0, 0.0, 0.0), "near": 2.8, "far": 3.5, "width": 64, "height": 48}
    if view == "orthographic":
        camera = ibr_ref.Camera.orthographic(view_height=1.7, **options)  # type: ignore[arg-type]
    else:
        camera = ibr_ref.Camera.look_at(vertical_fov=35.0, **options)  # type: ignore[arg-type]
    return splatting.Scene(images=images, camera=camera, light=LIGHTS[light], background=(0.1, 0.2, 0.3))


def law(shape: str = "square") -> splatting.Params:
    """Widths of some 2 to 5 pixels."""
    return splatting.Params(
        alpha=1.0, beta=0.01, gamma=0.02, delta=0.12, min_width=1.0, max_width=64.0, shape=shape, max_atlas_size=64
    )


def constant(width: float) -> splatting.Params:
    return splatting.Params(
        alpha=1.0, beta=0.0, gamma=0.0, delta=1.0, min_width=width, max_width=width, shape="square", max_atlas_size=64
    )


def case(view: splatting.Scene, params: splatting.Params) -> Case:
    """With the reference's normals, which ports are given."""
    frame = splatting.render(view, params)
    return Case(
        name="port",
        method="splatting",
        kind="typical",
        about="",
        profile="webgpu",
        scene=view,
        params=params,
        inputs={"normals": codes_of_atlas(frame.stages)},
    )


def codes_of_atlas(stages: dict[str, Any]) -> list[np.ndarray]:
    """The (H, W, 3) uint8 normals of every image."""
    pages = stages["atlas.normal"]
    return [pages[page][y : y + height, x : x + width] for page, x, y, width, height in stages["atlas.rects"].tolist()]


def drawn(port: Port, given: Case, **options: Any) -> Frame:
    """The port's frame of an exported case."""
    exported = described("splatting", given.scene, given.params, **given.inputs)
    return port.render(exported.scene, exported.params, **options)


def judged(given: Case, frame: Frame, profile: str = "webgpu") -> dict[str, Judgement]:
    """What the referee says of a port's frame, by stage."""
    picture = {"color": frame.color, "depth": frame.depth}
    found = REFEREE.judge_stages(given, PROFILES[profile], {**frame.stages, **picture})
    found.append(REFEREE.judge_image(given, PROFILES[profile], picture))
    return {judgement.stage: judgement for judgement in found}


def assert_legal(found: dict[str, Judgement], most_undecided: float) -> None:
    """Nothing is wrong, and enough of it is certain to say so."""
    assert list(found) == ["vertex", "raster", "resolve", "image"]
    for stage, judgement in found.items():
        assert not judgement.wrong.any(), (stage, np.argwhere(judgement.wrong)[:3].tolist())
        assert judgement.undecided.mean() <= most_undecided, stage


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("view", ["perspective", "orthographic"])
def test_vertices_are_legal(port: Port, view: str, light: str) -> None:
    given = case(scene(view, light), law())
    found = judged(given, drawn(port, given))["vertex"]
    kept = given.frame.stages["vertex.width"] > 0.0
    assert kept.sum() > 1000
    assert (~kept).sum() > 100, "the planes should cut some points off"
    assert not found.wrong.any()
    assert found.undecided.sum() <= 3
    assert np.median(found.width[kept]) < 1e-3, "bounds that mean something"


@pytest.mark.parametrize("light", ["baked", "point"])
@pytest.mark.parametrize("view", ["perspective", "orthographic"])
@pytest.mark.parametrize("shape", ["square", "disc"])
@pytest.mark.parametrize("primitive", ["points", "quads"])
def test_pictures_are_legal(port: Port, primitive: str, shape: str, view: str, light: str) -> None:
    given = case(scene(view, light), law(shape))
    assert (given.frame.stages["raster.overdraw"] > 0).mean() > 0.2
    assert_legal(judged(given, drawn(port, given, primitive=primitive)), most_undecided=0.03)


@pytest.mark.parametrize("primitive", ["points", "quads"])
def test_the_timed_variant_draws_the_same_picture(port: Port, primitive: str) -> None:
    given = case(scene(light="point"), law())
    staged = drawn(port, given, primitive=primitive)
    timed = drawn(port, given, primitive=primitive, stages=False)
    assert timed.stages == {}
    np.testing.assert_array_equal(staged.depth, timed.depth)
    assert abs(staged.color - timed.color).max() < 0.5001 / 255.0


@pytest.mark.parametrize("width", [1.0, 1.5, 2.0, 2.0 + 1.0 / 128.0, 3.0])
def test_quads_of_constant_width_leave_only_the_snapping_of_centres_open(port: Port, width: float) -> None:
    """Widths that are multiples of 1/128 have corners on the raster of 1/256, so that nothing is rounded there."""
    given = case(scene(), constant(width))
    assert_legal(judged(given, drawn(port, given, primitive="quads"), "ieee32"), most_undecided=0.01)


@pytest.mark.parametrize("width", [1.0 + 1.0 / 256.0, 2.0 + 1.0 / 256.0, 3.0 - 1.0 / 256.0])
def test_sprites_of_widths_between_the_steps_have_no_border_on_a_centre(port: Port, width: float) -> None:
    given = case(scene(), constant(width))
    assert_legal(judged(given, drawn(port, given, primitive="points")), most_undecided=0.03)


def test_the_half_open_rule_where_every_border_is_on_a_pixel_centre(port: Port) -> None:
    """Seen from the reference camera itself at width 2: each splat covers its pixel and those to the left and above."""
    image = reference("perspective", (3.0, 0.0, 0.5))
    given = case(splatting.Scene(images=[image], camera=image.camera, light=None), constant(2.0))
    assert given.frame.stages["raster.overdraw"].tolist() == [[4] * 29 + [2]] * 21 + [[2] * 29 + [1]]
    assert_legal(judged(given, drawn(port, given, primitive="quads"), "ieee32"), most_undecided=0.01)


def test_a_splat_whose_centre_is_outside_reaches_in(port: Port) -> None:
    """Sprites are culled by their centre; the port's larger viewport keeps them."""
    image = reference("perspective", (3.0, 0.0, 0.5))
    narrow = ibr_ref.Camera.look_at(
        eye=(3.0, 0.0, 0.5), target=(0, 0, 0), vertical_fov=15.0, near=0.5, far=9, width=40, height=32
    )
    given = case(splatting.Scene(images=[image], camera=narrow, light=None), constant(9.0 + 1.0 / 256.0))
    stages = given.frame.stages
    window = stages["vertex.window"][stages["raster.splat"][stages["raster.splat"] >= 0]]
    assert ((window < 0.0) | (window > [40.0, 32.0])).any(), "no winner has its centre outside: the test says nothing"
    for primitive in ("points", "quads"):
        assert_legal(judged(given, drawn(port, given, primitive=primitive)), most_undecided=0.03)


def test_a_broken_port_is_noticed(port: Port) -> None:
    """Normals and laws that are slightly off: none may pass."""
    given = case(scene(light="point"), law())
    codes = given.inputs["normals"]
    brighter = [np.where(each > 0, np.minimum(each.astype(int) + 1, 255), 0).astype(np.uint8) for each in codes]
    found = judged(given, drawn(port, replace(given, inputs={"normals": brighter})))
    assert [stage for stage, judgement in found.items() if judgement.wrong.any()] == ["vertex", "image"]
    for alpha in (1.0001, 1.1):
        wider = splatting.Params(alpha=alpha, beta=0.01, gamma=0.02, delta=0.12)
        found = judged(given, drawn(port, replace(given, params=wider)), "gl")
        vertex = found["vertex"]
        assert {vertex.arrays[i] for i in vertex.blame[vertex.wrong]} == {"vertex.width"}
    assert found["image"].wrong.any()


def test_what_is_not_ported_is_refused(port: Port) -> None:
    given = case(scene(), law())
    with pytest.raises(ValueError, match="primitive = 'hexagons'"):
        drawn(port, given, primitive="hexagons")
    wide = splatting.Params(alpha=1.0, beta=0.0, gamma=0.0, delta=1.0, max_width=1e5)
    with pytest.raises(ValueError, match=r"max_width = 100000\.0"):
        drawn(port, replace(given, params=wide), primitive="points")
