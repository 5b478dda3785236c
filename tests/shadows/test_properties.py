"""What must hold of any shadow: prepared places, moves of light and object together, sums of samples, closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

from ibr_ref.io import Frame
from ibr_ref.scene import Camera, Mesh
from ibr_ref.shadows import Scene, prepare, render
from ibr_ref.testing.shadows import Drawn as Case
from ibr_ref.testing.shadows import drawn as cases
from tests.shadows.scenes import Array, ball, light, params, plate, scene

derandomized = settings(derandomize=True, deadline=None, max_examples=25)

OVERHEAD = Camera.orthographic(
    eye=(0, 0, 9), target=(0, 0, 0), up=(0, 1, 0), view_height=3.0, near=1, far=20, width=60, height=60
)


def shadow_of(frame: Frame) -> Array:
    return np.asarray(frame.stages["accumulate.shadow"], np.float64)


# --- Warps -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("policy", ["dissolve", "nearest"])
@pytest.mark.parametrize("content", ["mask", "depth"])
@pytest.mark.parametrize("controls", ["bounds", "identity"])
def test_at_the_nine_places_the_warp_gives_back_the_prepared_map(policy: str, content: str, controls: str) -> None:
    """Within rounding: a coordinate that is not quite a texel's centre mixes its neighbour in, by 1e-13 or so.

    In 8 bits the maps are the same. The range's middle is the light's place, (0.1, 0).
    """
    lamp = light(position=(0.125, 0.0, 4.0))
    small = params(policy=policy, content=content)
    maps = prepare(scene(light=lamp), small, controls=controls)
    assert maps.positions[1, 1].tolist() == [0.125, 0.0]
    for j in range(3):
        for i in range(3):
            frame = render(scene(light=lamp, offset=maps.positions[j, i]), small, maps=maps)
            image = np.asarray(frame.stages["warp.image"], np.float64)
            assert np.abs(image - maps.image[j, i]).max() < 1e-11
            assert np.array_equal(np.floor(255 * image + 0.5), np.floor(255 * maps.image[j, i] + 0.5))


def test_maps_serve_every_offset() -> None:
    small = params(light_samples=5)
    maps = prepare(scene(), small)
    for offset in [(-0.5, -0.5), (0.5, 0.5), (0.1, 0.4)]:
        made_here = render(scene(offset=offset), small)
        assert np.array_equal(render(scene(offset=offset), small, maps=maps).color, made_here.color)


def test_moving_everything_but_the_ground_changes_no_map() -> None:
    """Light and caster by the same step of 1/8: the map that is projected is the same one."""
    here = render(scene(offset=(0.25, -0.125)), params(method="direct", content="depth"))
    lamp = light(position=(0.125, 0.25, 4.0), target=(0.125, 0.25, 0.0))
    there = render(scene(offset=(0.375, 0.125), light=lamp), params(method="direct", content="depth"))
    assert np.array_equal(here.stages["warp.image"], there.stages["warp.image"])


# --- Sums ------------------------------------------------------------------------------------------------------------


@derandomized
@given(cases())
def test_shadows_are_shares_and_colours_are_colours(case: Case) -> None:
    maps = prepare(case.scene, case.params, controls=case.controls) if case.params.method == "warp" else None
    frame = render(case.scene, case.params, maps=maps)
    for name in ("project.shadow", "accumulate.shadow", "warp.image"):
        values = np.asarray(frame.stages[name], np.float64)
        assert values.min() >= 0.0
        assert values.max() <= 1.0 + (1e-15 if name == "warp.image" else 0.0)
    assert frame.color.min() >= 0.0
    assert frame.color.max() <= 1.0


@pytest.mark.parametrize("count", [1, 5, 9])
@pytest.mark.parametrize("accumulation", ["float", "unorm8"])
def test_full_shadow_is_the_sum_of_all_alphas(count: int, accumulation: str) -> None:
    """1 as floats; in 8 bits N times the rounded 1/N: 5 x 51/255 is 1, 9 x 28/255 is not."""
    wide = scene(caster=plate(2.5), light=light(vertical_fov=90.0), camera=OVERHEAD)
    below = Camera.look_at(eye=(0, 0, -0.1), target=(0.3, 0, -1), near=0.01, far=20, width=8, height=8)
    covered = scene(caster=plate(2.5), light=light(vertical_fov=90.0), camera=below)
    for seen, full in ((wide, False), (covered, True)):
        values = shadow_of(render(seen, params(light_samples=count, accumulation=accumulation)))
        expected = {"float": {1: 1.0, 5: 1.0, 9: 1.0}, "unorm8": {1: 1.0, 5: 1.0, 9: 252 / 255}}[accumulation][count]
        assert values.max() == pytest.approx(expected if full else 0.0, abs=0.0 if accumulation == "unorm8" else 2e-16)


# --- Sides -----------------------------------------------------------------------------------------------------------


@derandomized
@given(cases())
def test_nothing_behind_the_light_or_beside_its_map_is_shadowed(case: Case) -> None:
    maps = prepare(case.scene, case.params, controls=case.controls) if case.params.method == "warp" else None
    stages = render(case.scene, case.params, maps=maps).stages
    coord, shadow = np.asarray(stages["project.coord"]), np.asarray(stages["project.shadow"])
    beside = (np.abs(coord[..., :2] - 0.5) > 0.5).any(axis=-1)
    behind = np.isinf(np.asarray(stages["project.texel_margin"]))
    assert not shadow[beside | behind].any()
    assert np.isinf(np.asarray(stages["project.margin"])[beside | behind]).all()


def test_a_ceiling_above_the_light_is_lit() -> None:
    """A plane behind the light is projected onto the map too, turned about: it must not show."""
    ceiling = scene(
        receivers=[plate(6.0, 5.0)],
        camera=Camera.look_at(eye=(0, -3, 2), target=(0, 0, 5), near=0.1, far=20, width=32, height=24),
    )
    for method in ("warp", "direct"):
        frame = render(ceiling, params(method=method, content="depth"))
        assert (frame.depth < 1).mean() > 0.5
        assert not shadow_of(frame).any()


def test_the_casters_own_fragments_are_lit_by_a_mask_and_compared_with_depths() -> None:
    seen = {"method": "direct", "bias": 0.0}
    lit = render(scene(camera=OVERHEAD, offset=(0, 0)), params(**seen)).stages
    caster = np.asarray(lit["project.coord"])[..., 2] < 0.9  # its top is at 0.825, the floor at 0.914
    assert caster.any()
    assert not np.asarray(lit["project.shadow"])[caster].any()
    compared = render(scene(camera=OVERHEAD, offset=(0, 0)), params(**seen, content="depth")).stages
    assert np.isfinite(np.asarray(compared["project.margin"])[caster]).all()
    assert np.isinf(np.asarray(lit["project.margin"])).all()


# --- Closed forms ----------------------------------------------------------------------------------------------------


def floor_points(seen: Scene, frame: Frame) -> tuple[Array, Array, Any]:
    """World x and y of an overhead picture's pixels, and where it shows the floor z = -1."""
    size = seen.camera.width
    at = ((np.arange(size) + 0.5) / size - 0.5) * 3.0
    x, y = np.meshgrid(at, -at)
    depth_of_floor = 9.0 / 19.0  # at a distance of 10, between 1 and 20
    return x, y, np.abs(frame.depth - depth_of_floor) < 1e-9


def far_from(edge: Any, texel: float) -> Any:
    """Pixels of the floor whose signed distance from the shadow's outline is not within a texel or so."""
    return np.abs(edge) > texel


@pytest.mark.parametrize("content", ["mask", "depth"])
def test_the_shadow_of_a_ball_is_an_ellipse(content: str) -> None:
    """A ray from the light meets the ball if its distance from the centre is below the radius."""
    lamp = light(position=(-1.5, 0.5, 3.0), target=(0.0, 0.0, 0.0), vertical_fov=45.0)
    seen = scene(caster=ball(0.5), light=lamp, camera=OVERHEAD, offset=(0.2, -0.1))
    frame = render(seen, params(map_size=512, method="direct", content=content))
    x, y, floor = floor_points(seen, frame)
    l, c = np.array([-1.5, 0.5, 3.0]), np.array([0.2, -0.1, 0.0])
    ray = np.stack([x, y, np.full(x.shape, -1.0)], axis=-1) - l
    distance = np.linalg.norm(np.cross(ray, c - l), axis=-1) / np.linalg.norm(ray, axis=-1)
    sure = floor & far_from(distance - 0.5, 0.01)
    assert sure.sum() > 0.95 * floor.sum()
    assert np.array_equal(shadow_of(frame)[sure] > 0.5, (distance < 0.5)[sure])
    assert (shadow_of(frame)[sure] > 0.5).sum() > 50


@pytest.mark.parametrize("content", ["mask", "depth"])
def test_the_shadow_of_a_box_is_what_rays_through_it_reach(content: str) -> None:
    """By slabs, from the floor to the light."""
    lamp = light(position=(1.0, -1.5, 3.0), target=(0.0, 0.0, 0.0), vertical_fov=50.0)
    seen = scene(light=lamp, camera=OVERHEAD, offset=(-0.1, 0.3))
    frame = render(seen, params(map_size=512, method="direct", content=content))
    x, y, floor = floor_points(seen, frame)
    l, c = np.array([1.0, -1.5, 3.0]), np.array([-0.1, 0.3, 0.0])
    p = np.stack([x, y, np.full(x.shape, -1.0)], axis=-1)
    near, far = ((c + side * 0.4 - p) / (l - p) for side in (-1, 1))
    gap = np.minimum(np.maximum(near, far).min(axis=-1), 1.0) - np.maximum(np.minimum(near, far).max(axis=-1), 0.0)
    sure = floor & far_from(gap, 0.01)
    assert sure.sum() > 0.9 * floor.sum()
    assert np.array_equal(shadow_of(frame)[sure] > 0.5, (gap > 0)[sure])
    assert (shadow_of(frame)[sure] > 0.5).sum() > 50


def test_pcf_mixes_the_four_comparisons() -> None:
    sharp, mixed = (
        render(scene(camera=OVERHEAD), params(method="direct", content="depth", pcf=pcf)).stages
        for pcf in (False, True)
    )
    a, b = (np.asarray(s["project.shadow"]) for s in (sharp, mixed))
    assert set(np.unique(a)) == {0.0, 1.0}
    assert ((b > 0.0) & (b < 1.0)).any()
    assert np.array_equal(a[(b == 0.0) | (b == 1.0)], b[(b == 0.0) | (b == 1.0)])


def test_quantized_depths_are_compared_in_steps_of_255() -> None:
    """A plate a little above the floor: its shadow is lost where both depths are rounded to the same step."""
    lamp, outcomes = light(near=0.5, far=1000.0), set()

    def step(distance: float, bias: float) -> int:
        return math.floor(255 * (1000 / 999.5 * (1 - 0.5 / distance) - bias) + 0.5)

    for height in (0.02, 0.06, 0.1, 0.14, 0.18, 0.22, 0.26, 0.3):
        close = scene(caster=plate(0.5, height - 1.0), light=lamp, camera=OVERHEAD)
        fine, coarse = (
            shadow_of(render(close, params(method="direct", content="depth", bias=1e-4, quantize=quantize)))
            for quantize in (None, 8)
        )
        assert fine.any()
        expected = step(5.0, 1e-4) > step(5.0 - height, 0.0)
        assert coarse.any() == expected
        outcomes.add(expected)
    assert outcomes == {True, False}


def test_softer_the_larger_the_light() -> None:
    """The share of half shadows grows with the light, and 9 samples have at most 9 steps without a bilinear fetch."""
    shares = []
    for edge in (0.05, 0.4):
        lamp = light(half_edges=((edge, 0, 0), (0, edge, 0)))
        soft = params(light_samples=9, method="direct", content="depth", map_size=256)
        values = shadow_of(render(scene(light=lamp, camera=OVERHEAD), soft))
        assert np.abs(values * 9 - np.rint(values * 9)).max() < 1e-12
        shares.append(((values > 0.01) & (values < 0.99)).mean())
    assert shares[1] > 2 * shares[0] > 0


def test_an_open_sky_shows_the_background() -> None:
    up = Camera.look_at(eye=(0, 0, 3), target=(0.1, 0, 9), near=0.1, far=20, width=8, height=8)
    frame = render(scene(camera=up, background=(0.1, 0.2, 0.3)), params())
    assert (frame.color == [0.1, 0.2, 0.3]).all()
    assert (frame.depth == 1.0).all()
    assert np.isinf(np.asarray(frame.stages["project.margin"])).all()
    assert not np.asarray(frame.stages["project.coord"]).any()


def test_colours_of_vertices_are_interpolated_and_those_of_meshes_are_not() -> None:
    corners = np.array([(1.0, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)])
    floor = plate(6.0, -1.0)
    painted = Mesh(vertices=floor.vertices, triangles=floor.triangles, color=corners)
    far_away = light(position=(9.0, 0.0, 4.0), target=(9.0, 0.0, 0.0))
    plain = render(scene(receivers=[plate(6.0, -1.0, color=(0.1, 0.7, 0.3))], ambient=1.0, light=far_away), params())
    shown = plain.color[plain.depth < 1.0]
    assert len(np.unique(shown, axis=0)) == 2  # floor and caster
    mixed = render(scene(receivers=[painted], ambient=1.0, light=far_away), params())
    assert len(np.unique(mixed.color.reshape(-1, 3), axis=0)) > 100
