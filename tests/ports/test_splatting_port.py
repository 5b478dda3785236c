"""The GLSL port of splatting on a real OpenGL, against the reference: equal wherever float32 cannot turn a decision."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import ibr_ref
from ibr_ref import splatting

moderngl = pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")

from tests.ports.normals import normal_codes  # noqa: E402
from tests.ports.rounding import LOOSE, Rounded  # noqa: E402
from tests.ports.splatting import Frame, Port, codes_of_atlas  # noqa: E402
from tests.ports.splatting_bounds import SUBPIXEL, undecided_pixels, vertex_bounds  # noqa: E402

SNAPPED_TWICE = SUBPIXEL + 1e-4
"""A driver may snap the width of a sprite, and a border of a quad, to 1/256 once the centre is: 1/256 pixel off, no more."""

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


def assert_vertices_agree(
    bounds: dict[str, Rounded], stages: dict[str, np.ndarray], ported: dict[str, np.ndarray]
) -> None:
    """Window, depth, width and colour within their bounds, and the same points kept, but for those on a clip plane."""
    np.testing.assert_array_equal(stages["vertex.source"], ported["vertex.source"])
    on_a_plane = (abs(bounds["near"].value) <= bounds["near"].error) | (abs(bounds["far"].value) <= bounds["far"].error)
    kept = stages["vertex.width"] > 0.0
    np.testing.assert_array_equal((ported["vertex.width"] > 0.0)[~on_a_plane], kept[~on_a_plane])
    assert on_a_plane.sum() <= 3
    assert kept.sum() > 1000
    for plane in ("near", "far"):
        assert (bounds[plane].value < -bounds[plane].error).any(), f"the {plane} plane should cut some points off"
    kept &= ported["vertex.width"] > 0.0
    columns = {
        "window_x": ("window", 0),
        "window_y": ("window", 1),
        "depth": ("depth",),
        "width": ("width",),
        "color": ("color",),
    }
    for name, (stage, *index) in columns.items():
        ours, theirs = (each[f"vertex.{stage}"][(kept, *index)] for each in (stages, ported))
        # The bounds' own float64 evaluation is a third witness.
        np.testing.assert_allclose(bounds[name].value[kept], ours, rtol=1e-9, atol=1e-9, err_msg=name)
        excess = abs(ours - theirs) - bounds[name].error[kept]
        assert excess.max() <= 1e-12, (name, excess.max(), bounds[name].error[kept].max())


def assert_pictures_agree(
    bounds: dict[str, Rounded], frame: object, drawn: Frame, undecided: np.ndarray, least_decided: float
) -> None:
    """Winners equal, depths and colours within the bounds of the winner, wherever no rounding can turn the decision."""
    stages, ported = frame.stages, drawn.stages
    winner = stages["raster.splat"]
    decided = ~undecided
    covered = stages["raster.overdraw"] > 0
    assert covered.mean() > 0.2
    assert (decided & covered).sum() > least_decided * covered.sum(), "hardly a pixel is certain: the test says nothing"
    wrong = decided & (winner != ported["raster.splat"])
    assert not wrong.any(), (wrong.sum(), np.argwhere(wrong)[:3].tolist())
    seen = decided & (winner >= 0)
    off = abs(stages["raster.depth"] - ported["raster.depth"])
    assert (off[seen] <= bounds["depth"].error[winner[seen]] + LOOSE).all()
    assert (off[decided & ~covered] == 0.0).all()
    off = abs(frame.color - drawn.color)
    assert (off[seen] <= bounds["color"].error[winner[seen]] + 1e-12).all()
    assert off[decided & ~covered].max(initial=0.0) < 1e-7


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("view", ["perspective", "orthographic"])
def test_vertices_agree_within_float32_bounds(port: Port, view: str, light: str) -> None:
    described = scene(view, light)
    frame = splatting.render(described, law(), stages=True)
    codes = codes_of_atlas(frame.stages)
    drawn = port.render(described, law(), normals=codes)
    bounds = vertex_bounds(described, law(), codes)
    assert_vertices_agree(bounds, frame.stages, drawn.stages)
    kept = frame.stages["vertex.width"] > 0.0
    largest = {name: bounds[name].error[kept].max() for name in ("window_x", "window_y", "depth", "width", "color")}
    assert max(largest["window_x"], largest["window_y"]) < 1e-3, largest  # bounds that mean something
    assert largest["depth"] < 2e-5, largest
    assert largest["width"] < 1e-4, largest
    assert np.median(bounds["color"].error[kept]) < 1e-4, largest


@pytest.mark.parametrize("light", ["baked", "point"])
@pytest.mark.parametrize("view", ["perspective", "orthographic"])
@pytest.mark.parametrize("shape", ["square", "disc"])
@pytest.mark.parametrize("primitive", ["points", "quads"])
def test_winners_agree_where_decided(port: Port, primitive: str, shape: str, view: str, light: str) -> None:
    described = scene(view, light)
    frame = splatting.render(described, law(shape), stages=True)
    codes = codes_of_atlas(frame.stages)
    drawn = port.render(described, law(shape), normals=codes, primitive=primitive)
    bounds = vertex_bounds(described, law(shape), codes)
    undecided = undecided_pixels(bounds, frame.stages, shape, SNAPPED_TWICE)
    assert_pictures_agree(bounds, frame, drawn, undecided, least_decided=0.95)


@pytest.mark.parametrize("primitive", ["points", "quads"])
def test_the_timed_variant_draws_the_same_picture(port: Port, primitive: str) -> None:
    described = scene(light="point")
    staged = port.render(described, law(), primitive=primitive)
    timed = port.render(described, law(), primitive=primitive, stages=False)
    assert timed.stages == {}
    np.testing.assert_array_equal(staged.depth, timed.depth)
    assert abs(staged.color - timed.color).max() < 0.5001 / 255.0


@pytest.mark.parametrize("width", [1.0, 1.5, 2.0, 2.0 + 1.0 / 128.0, 3.0])
def test_quads_of_constant_width_leave_only_the_snapping_of_centres_open(port: Port, width: float) -> None:
    """Widths that are multiples of 1/128 have corners on the raster of 1/256, so that nothing is rounded there."""
    described = scene()
    frame = splatting.render(described, constant(width), stages=True)
    codes = codes_of_atlas(frame.stages)
    drawn = port.render(described, constant(width), primitive="quads", normals=codes)
    bounds = vertex_bounds(described, constant(width), codes)
    undecided = undecided_pixels(bounds, frame.stages, "square", slack=0.0)
    assert_pictures_agree(bounds, frame, drawn, undecided, least_decided=0.95)


@pytest.mark.parametrize("width", [1.0 + 1.0 / 256.0, 2.0 + 1.0 / 256.0, 3.0 - 1.0 / 256.0])
def test_sprites_of_widths_between_the_steps_have_no_border_on_a_centre(port: Port, width: float) -> None:
    described = scene()
    frame = splatting.render(described, constant(width), stages=True)
    codes = codes_of_atlas(frame.stages)
    drawn = port.render(described, constant(width), normals=codes)
    bounds = vertex_bounds(described, constant(width), codes)
    undecided = undecided_pixels(bounds, frame.stages, "square", SNAPPED_TWICE)
    assert_pictures_agree(bounds, frame, drawn, undecided, least_decided=0.95)


def test_the_half_open_rule_where_every_border_is_on_a_pixel_centre(port: Port) -> None:
    """Seen from the reference camera itself at width 2: each splat covers its pixel and those to the left and above."""
    image = reference("perspective", (3.0, 0.0, 0.5))
    described = splatting.Scene(images=[image], camera=image.camera, light=None, background=(0.0, 0.0, 0.0))
    frame = splatting.render(described, constant(2.0), stages=True)
    bounds = vertex_bounds(described, constant(2.0), codes_of_atlas(frame.stages))
    undecided = undecided_pixels(bounds, frame.stages, "square", slack=0.0)
    assert frame.stages["raster.overdraw"].tolist() == [[4] * 29 + [2]] * 21 + [[2] * 29 + [1]]
    drawn = port.render(described, constant(2.0), primitive="quads")
    assert_pictures_agree(bounds, frame, drawn, undecided, least_decided=0.99)


def test_a_splat_whose_centre_is_outside_reaches_in(port: Port) -> None:
    """Sprites are culled by their centre; the port's larger viewport keeps them."""
    image = reference("perspective", (3.0, 0.0, 0.5))
    narrow = ibr_ref.Camera.look_at(
        eye=(3.0, 0.0, 0.5), target=(0, 0, 0), vertical_fov=15.0, near=0.5, far=9, width=40, height=32
    )
    described = splatting.Scene(images=[image], camera=narrow, light=None, background=(0.0, 0.0, 0.0))
    wide = constant(9.0 + 1.0 / 256.0)
    frame = splatting.render(described, wide, stages=True)
    bounds = vertex_bounds(described, wide, codes_of_atlas(frame.stages))
    undecided = undecided_pixels(bounds, frame.stages, "square", SNAPPED_TWICE)
    window = frame.stages["vertex.window"][frame.stages["raster.splat"][frame.stages["raster.splat"] >= 0]]
    assert ((window < 0.0) | (window > [40.0, 32.0])).any(), "no winner has its centre outside: the test says nothing"
    for primitive in ("points", "quads"):
        drawn = port.render(described, wide, primitive=primitive)
        assert_pictures_agree(bounds, frame, drawn, undecided, least_decided=0.95)


def test_normals_made_in_numpy_are_the_reference_s() -> None:
    described = scene()
    codes = codes_of_atlas(splatting.render(described, law(), stages=True).stages)
    for image, theirs in zip(described.images, codes, strict=True):
        np.testing.assert_array_equal(normal_codes(image), theirs)


def test_a_broken_port_is_noticed(port: Port) -> None:
    """The same comparisons with a light, a law and a depth that are slightly off: none may pass."""
    described = scene(light="point")
    frame = splatting.render(described, law(), stages=True)
    codes = codes_of_atlas(frame.stages)
    bounds = vertex_bounds(described, law(), codes)
    brighter = [np.where(each > 0, each.astype(int) + 1, 0).clip(0, 255).astype(np.uint8) for each in codes]
    drawn = port.render(described, law(), normals=brighter)
    with pytest.raises(AssertionError, match="color"):
        assert_vertices_agree(bounds, frame.stages, drawn.stages)
    wider = splatting.Params(alpha=1.0001, beta=0.01, gamma=0.02, delta=0.12)
    with pytest.raises(AssertionError, match="width"):
        assert_vertices_agree(bounds, frame.stages, port.render(described, wider, normals=codes).stages)
    undecided = undecided_pixels(bounds, frame.stages, "square", SNAPPED_TWICE)
    much_wider = splatting.Params(alpha=1.1, beta=0.01, gamma=0.02, delta=0.12)
    drawn = port.render(described, much_wider, normals=codes)
    with pytest.raises(AssertionError):
        assert_pictures_agree(bounds, frame, drawn, undecided, least_decided=0.95)


def test_what_is_not_ported_is_refused(port: Port) -> None:
    described = scene()
    with pytest.raises(ValueError, match="primitive = 'hexagons'"):
        port.prepare(described, law(), primitive="hexagons")
    with pytest.raises(ValueError, match=r"max_width = 100000\.0"):
        port.prepare(described, splatting.Params(alpha=1.0, beta=0.0, gamma=0.0, delta=1.0, max_width=1e5))
    image = reference("perspective", (3.0, 0.0, 0.5))
    grey = ibr_ref.DepthImage(color=np.full((22, 30, 3), 0.3333), depth=image.depth, camera=image.camera)
    with pytest.raises(ValueError, match=r"images\[0\]\.color"):
        port.prepare(splatting.Scene(images=[grey], camera=image.camera, light=None), law())
