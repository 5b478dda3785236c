"""The GLSL port of shadows on a real OpenGL, against the reference: equal wherever float32 cannot turn a decision."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ibr_ref
from ibr_ref import shadows

moderngl = pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")

from tests.ports.rounding import UNIT  # noqa: E402
from tests.ports.shadow_maps import light_samples  # noqa: E402
from tests.ports.shadows import Frame, Port  # noqa: E402
from tests.ports.shadows_bounds import (  # noqa: E402
    SNAPPED,
    Seen,
    around_pixel,
    fetched_error,
    lit,
    projected,
    seen,
    warped_errors,
)

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


SCENES = {"on the raster": (on_the_raster, 0.0), "anywhere": (anywhere, SNAPPED)}


def moved_controls() -> np.ndarray:
    """Nine grids, inner points moved by multiples of 1/128."""
    grid = np.stack(np.meshgrid(np.linspace(0, 1, COLUMNS), np.linspace(0, 1, ROWS)), axis=-1)
    controls = np.broadcast_to(grid, (3, 3, ROWS, COLUMNS, 2)).copy()
    controls[:, :, 1:-1, 1:-1] += np.random.default_rng(7).integers(-5, 6, (3, 3, ROWS - 2, COLUMNS - 2, 2)) / 128.0
    return controls


def case(scene: str, name: str) -> SimpleNamespace:
    """A scene with parameters, the maps of it if it has some, the reference's frame, and how far corners may be moved."""
    make, shift = SCENES[scene]
    params = shadows.Params(map_size=SIZE, rows=ROWS, columns=COLUMNS, **CASES[name])
    described = make(params.light_samples)
    maps = shadows.prepare(described, params, controls=moved_controls()) if params.method == "warp" else None
    frame = shadows.render(described, params, maps=maps)
    return SimpleNamespace(scene=described, params=params, maps=maps, frame=frame, shift=shift)


def per_sample(stages: Arrays, name: str, params: Any) -> np.ndarray:
    return stages[name][None] if params.light_samples == 1 else stages[name]


def map_errors(given: SimpleNamespace, drawn: Frame) -> np.ndarray:
    """(N, S, S) bounds of warp.image, inf where coverage is open, after the comparison of rows and maps."""
    ours, theirs = (per_sample(each.stages, "warp.image", given.params) for each in (given.frame, drawn))
    errors = []
    for number, sample in enumerate(light_samples(given.scene, given.params)):
        if given.params.method == "direct":
            errors.append(direct_error(given, sample.position, given.scene.offset))
        else:
            rows = [per_sample(each.stages, "warp.rows", given.params)[number] for each in (given.frame, drawn)]
            row_error, error = warped_errors(
                given.maps, {"warp.rows": rows[0]}, sample, given.params.policy, given.shift
            )
            assert (abs(rows[0] - rows[1]) <= row_error).all(), (abs(rows[0] - rows[1]) - row_error).max()
            errors.append(error)
        off = abs(ours[number] - theirs[number])
        assert (off <= errors[-1]).all(), (off - errors[-1]).max()
    return np.stack(errors)


def direct_error(given: SimpleNamespace, position: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """(S, S) of a rendered map: inf next to edges, elsewhere 0 for masks and float32's bound for depths."""
    found = seen(
        SimpleNamespace(
            receivers=[],
            caster=given.scene.caster,
            camera=given.scene.light.camera(SIZE, position),
            offset=offset,
            offset_axes=given.scene.offset_axes,
        ),
        SNAPPED,
    )
    error = np.where(found.certain, 0.0, np.inf)
    if given.params.content == "depth":
        error[found.decided] = around_pixel([point[0] for point in found.depth]).error
    assert found.certain.mean() > 0.9
    return error


def shadow_errors(given: SimpleNamespace, found: Seen, maps_off: np.ndarray, drawn: Frame) -> list[np.ndarray]:
    """(n,) bounds of project.shadow for every sample, 1 where open, after the comparison of coordinates."""
    params, errors = given.params, []
    for number, sample in enumerate(light_samples(given.scene, params)):
        stage = {
            name: per_sample(given.frame.stages, f"project.{name}", params)[number][found.decided]
            for name in ("coord", "margin", "texel_margin")
        }
        coord = projected(given.scene.light, SIZE, sample.position, found.world)
        theirs = per_sample(drawn.stages, "project.coord", params)[number][found.decided]
        for k in range(3):
            np.testing.assert_allclose(
                np.clip(coord[k].value, 0, 1) if k == 2 else coord[k].value, stage["coord"][:, k], atol=1e-9
            )
            assert (abs(theirs[:, k] - stage["coord"][:, k]) <= coord[k].error + 1e-12).all(), k
        s, t, r = coord
        image = per_sample(given.frame.stages, "warp.image", params)[number]
        off = tuple(SIZE * each.error + 4.0 * UNIT * SIZE for each in (s, t))
        x, y = SIZE * s.value - 0.5, SIZE * t.value - 0.5
        fetched = fetched_error(image, maps_off[number], x, y, off)
        if params.content == "depth":
            stable = stage["margin"] > r.error + fetched_error(np.zeros_like(image), maps_off[number], x, y, off)
            if params.pcf:  # continuous from cell to cell, if the same texels are compared
                same_cell = [abs(each - np.rint(each)) > o for each, o in zip((x, y), off, strict=True)]
                fetched = np.where(stable & same_cell[0] & same_cell[1], off[0] + off[1] + 8.0 * UNIT, 1.0)
            else:
                fetched = np.where(stable & (stage["texel_margin"] > np.maximum(*off)), 0.0, 1.0)
            fetched[~np.isfinite(stage["margin"])] = 0.0
        else:
            fetched[found.kind == 2] = 0.0
        border = np.minimum(abs(s.value - np.rint(s.value)), abs(t.value - np.rint(t.value)))
        fetched[border <= np.maximum(s.error, t.error)] = 1.0
        errors.append(np.minimum(fetched, 1.0))
    return errors


def assert_agree(given: SimpleNamespace, drawn: Frame, least_decided: float = 0.8) -> dict[str, float]:
    """Every stage within its bound, wherever there is one; gives the largest differences."""
    params, frame = given.params, given.frame
    maps_off = map_errors(given, drawn)
    found = seen(given.scene, given.shift)
    assert found.certain.mean() > least_decided
    pixels = found.decided
    np.testing.assert_array_equal(drawn.stages["raster.kind"][pixels], found.kind)
    depth = around_pixel([point[0] for point in found.depth])
    assert (abs(frame.depth - drawn.depth)[pixels] <= depth.error).all()
    errors = shadow_errors(given, found, maps_off, drawn)
    ours, theirs = (per_sample(each.stages, "project.shadow", params) for each in (frame, drawn))
    for number, error in enumerate(errors):
        assert (error < 0.1).mean() > least_decided, (error < 0.1).mean()
        assert (abs(ours[number] - theirs[number])[pixels] <= error).all(), number
    count = len(errors)
    steps = count / 255.0 if params.accumulation == "unorm8" else 2.0 * count * UNIT
    total = np.sum(errors, axis=0) / count + steps
    accumulated = abs(frame.stages["accumulate.shadow"] - drawn.stages["accumulate.shadow"])[pixels]
    assert (accumulated <= total).all()
    assert_colors_agree(given, drawn, found, total)
    assert 0.01 < (frame.stages["accumulate.shadow"] > 0.2).mean() < 0.8, "hardly a shadow: the test says nothing"
    return {"map": float(maps_off[np.isfinite(maps_off)].max()), "shadow": float(np.median(total))}


def assert_colors_agree(given: SimpleNamespace, drawn: Frame, found: Seen, shadow_error: np.ndarray) -> None:
    """surface (ambient + (1 - ambient) (1 - shadow) max(0, n . l)), and the background."""
    light = lit(given.scene, found)
    diffuse = (1.0 - given.scene.ambient) * (light.value * shadow_error + light.error)
    for channel in range(3):
        surface = around_pixel([point[channel] for point in found.color])
        error = (surface.value + surface.error) * diffuse + surface.error + 16.0 * UNIT
        off = abs(given.frame.color - drawn.color)[found.decided, channel]
        assert (off <= error).all(), (channel, (off - error).max())
    empty = found.certain & ~found.decided
    assert abs(given.frame.color - drawn.color)[empty].max(initial=0.0) < 1e-7


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("scene", SCENES)
def test_every_stage_agrees(port: Port, scene: str, name: str) -> None:
    given = case(scene, name)
    drawn = port.render(given.scene, given.params, maps=given.maps)
    largest = assert_agree(given, drawn, least_decided=0.5 if given.params.quantize else 0.8)
    if scene == "on the raster" and given.params.method == "warp" and given.params.content == "mask":
        assert largest["map"] < 2e-3, largest  # bounds that mean something


def test_the_top_left_rule_where_edges_meet_pixel_centres(port: Port) -> None:
    """Seen from above the box's edges run through centres: whoever covers them is the same, so the depth is."""
    given = case("on the raster", "dissolve")
    drawn = port.render(given.scene, given.params, maps=given.maps)
    assert abs(given.frame.depth - drawn.depth).max() < 1e-5
    columns = [(drawn.stages["raster.kind"] == 2).any(axis=axis).nonzero()[0] for axis in (0, 1)]
    assert [(int(each[0]), int(each[-1])) for each in columns] == [(18, 22), (15, 19)]


@pytest.mark.parametrize("content", ["mask", "depth"])
@pytest.mark.parametrize("scene", SCENES)
def test_nine_maps_agree(port: Port, scene: str, content: str) -> None:
    given = case(scene, "dissolve" if content == "mask" else "depth")
    drawn = port.maps(given.scene, given.params, given.maps.positions)
    for j in range(3):
        for i in range(3):
            error = direct_error(given, np.asarray(given.scene.light.position), given.maps.positions[j, i])
            assert (abs(drawn[j, i] - given.maps.image[j, i]) <= error).all(), (j, i)


@pytest.mark.parametrize("name", ["dissolve", "nine, unorm8", "depth", "direct"])
def test_the_timed_variant_draws_nearly_the_same_picture(port: Port, name: str) -> None:
    """Bytes and the sampler's own filter: a mix of two rounded twice, and 8 bits of colour, light and result."""
    given = case("anywhere", name)
    staged = port.render(given.scene, given.params, maps=given.maps)
    timed = port.render(given.scene, given.params, maps=given.maps, stages=False)
    assert timed.stages == {}
    np.testing.assert_array_equal(staged.depth, timed.depth)
    assert abs(staged.color - timed.color).max() < 0.03
    assert abs(staged.color - timed.color).mean() < 0.003


def test_a_broken_port_is_noticed(port: Port) -> None:
    """The same comparisons with controls, an offset and a light that are slightly off: none may pass."""
    given = case("on the raster", "dissolve")
    render = lambda scene, maps: port.render(scene, given.params, maps=maps)  # noqa: E731
    assert_agree(given, render(given.scene, given.maps))
    moved = moved_controls()
    moved[1, 1, 2, 1, 0] += 1.0 / 128.0
    with pytest.raises(AssertionError):
        assert_agree(given, render(given.scene, replace(given.maps, controls=moved)))
    with pytest.raises(AssertionError):
        assert_agree(given, render(replace(given.scene, offset=(0.1885, -0.3125)), given.maps))
    with pytest.raises(AssertionError):
        assert_agree(given, render(replace(given.scene, ambient=0.251), given.maps))
    turned = replace(given.scene.light, target=(0.001, 0.0, -1.0))
    with pytest.raises(AssertionError):
        assert_agree(given, render(replace(given.scene, light=turned), given.maps))


def test_what_is_not_ported_is_refused(port: Port) -> None:
    scene = on_the_raster(1)
    with pytest.raises(ValueError, match="method = 'grid'"):
        port.prepare(scene, shadows.Params(method="grid"))
    with pytest.raises(ValueError, match="map_samples = 2"):
        port.prepare(scene, shadows.Params(method="direct", map_samples=2))
