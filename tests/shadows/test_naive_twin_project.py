"""The naive twin of the shadows against closed forms, stages 4 to 6: projection, accumulation, colour."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.naive import shadow_light, shadow_project, shadows
from tests.shadows.plates import (
    HALF_PLATE,
    HEIGHT,
    PLATE_HEIGHT,
    example,
    parameters,
    rigid_controls,
    same_controls,
    soft_scene,
)

# --- Project ---------------------------------------------------------------------------------------------------------


def lit_by_rays(scene: Any, world: np.ndarray, light: Any) -> float:
    """How far inside (> 0) or outside (< 0) the plate the ray from a floor point to the light passes."""
    t = PLATE_HEIGHT / light[2]
    crossing = world[:2] + t * (np.asarray(light[:2]) - world[:2]) - scene.offset
    return float(HALF_PLATE - np.abs(crossing).max())


def floor_points(scene: Any) -> dict[tuple[int, int], np.ndarray]:
    """World points of the pixels that show the floor."""
    points = {}
    for row, line in enumerate(shadows.visible_surface(scene)):
        for column, fragment in enumerate(line):
            if fragment is not None and not fragment.caster:
                points[row, column] = np.array(fragment.world)
    return points


@pytest.mark.parametrize("method", ["warp", "direct", "grid"])
@pytest.mark.parametrize("content", ["mask", "depth"])
def test_shadow_of_a_plate_is_where_rays_meet_it(method: str, content: str) -> None:
    scene = example(offset=(0.1, -0.2))  # a prepared place: the warp is exact
    if method == "grid":
        scene = example(offset=(-0.5, 0.5))
    params = parameters(method=method, content=content, map_size=64, grid_size=3)
    stages, color, depth = shadows.render(scene, params, same_controls(3, 5))
    checked = {0.0: 0, 1.0: 0}
    for pixel, world in floor_points(scene).items():
        depth_inside = lit_by_rays(scene, world, scene.light.position)
        if abs(depth_inside) > 0.09:  # two texels of the map, on the plate
            expected = 1.0 if depth_inside > 0 else 0.0
            assert stages["project.shadow"][pixel] == pytest.approx(expected, abs=1e-12)
            checked[expected] += 1
            to_light = np.array(scene.light.position) - world
            brightness = 0.25 + 0.75 * (1 - expected) * to_light[2] / np.linalg.norm(to_light)
            assert color[pixel] == pytest.approx(brightness * np.array([0.5, 0.6, 0.7]))
            assert depth[pixel] < 1.0
    assert checked[1.0] >= 3
    assert checked[0.0] > 100


def test_the_caster_hides_the_floor_and_lies_in_no_shadow_of_its_mask() -> None:
    scene = example()
    stages, _, depth = shadows.render(scene, parameters(method="direct", map_size=16))
    surface = shadows.visible_surface(scene)
    own = [(r, c) for r, line in enumerate(surface) for c, f in enumerate(line) if f is not None and f.caster]
    assert len(own) > 5
    for pixel in own:
        assert stages["project.shadow"][pixel] == 0.0
        assert depth[pixel] < 1.0
    deep = shadows.render(scene, parameters(method="direct", map_size=16, content="depth"))[0]
    for pixel in own:  # a plate that faces the light is compared with itself: r = texel
        assert deep["project.shadow"][pixel] == 0.0
    inner = [deep["project.margin"][pixel] for pixel in own]  # at the plate's rim the texel may be an empty one
    assert np.median(inner) == pytest.approx(1e-3, abs=1e-9)


def test_coordinates_of_the_centre_and_the_corners_of_the_map() -> None:
    scene = example()
    camera = shadow_light.camera_at(scene.light, scene.light.position)
    (s, t, r), w = shadow_project.map_coordinate((0.1, -0.2, 0.0), camera)
    assert (s, t, w) == pytest.approx((0.5, 0.5, HEIGHT))
    assert r == pytest.approx((10.0 / 9.0) * (1.0 - 1.0 / HEIGHT))
    reach = HEIGHT * math.tan(math.radians(30.0))
    (s, t, _), _ = shadow_project.map_coordinate((0.1 - reach, -0.2 + reach, 0.0), camera)
    assert (s, t) == pytest.approx((0.0, 0.0), abs=1e-15)  # x to the right, y up: the top left texel
    _, behind = shadow_project.map_coordinate((0.1, -0.2, HEIGHT + 1.0), camera)
    assert behind == -1.0


def look(coord: tuple[float, float, float], image: Any, **changes: Any) -> shadow_project.Lookup:
    fragment = SimpleNamespace(caster=False)
    texture = shadow_project.Texture(np.array(image), False)
    return shadow_project.look_up(fragment, coord, 1.0, texture, parameters(content="depth", bias=0.0, **changes))


def test_comparisons() -> None:
    image = [[0.25, 0.75], [0.5, 1.0]]
    assert look((0.2, 0.2, 0.5), image) == (1.0, 0.25)
    assert look((0.8, 0.2, 0.5), image) == (0.0, 0.25)
    assert look((0.2, 0.8, 0.5), image) == (0.0, 0.0)  # equal is lit
    assert look((0.5, 0.375, 0.625), image, pcf=True) == (0.5 * 0.75 + 0.5 * 0.25, 0.125)
    assert look((1.0, 1.0, 1.0), image) == (0.0, 0.0)  # the border belongs to the map
    assert look((1.0001, 0.5, 1.0), image) == (0.0, math.inf)


def test_quantized_comparison_hides_what_rounds_away() -> None:
    image = [[100.2 / 255.0]]
    same = look((0.5, 0.5, 100.4 / 255.0), image, quantize=8)
    assert same.shadow == 0.0
    assert same.margin == pytest.approx(0.1 / 255.0)
    other = look((0.5, 0.5, 100.6 / 255.0), image, quantize=8)
    assert other.shadow == 1.0
    assert other.margin == pytest.approx(0.1 / 255.0)


def test_margin_to_the_next_texel() -> None:
    assert shadow_project.texel_margin((0.55, 0.25 + 0.3 / 16, 0.0), 1.0, 16) == pytest.approx(0.2)
    assert shadow_project.texel_margin((0.53, 0.5, 0.0), 1.0, 16) == 0.0
    assert shadow_project.texel_margin((0.53, 0.53, 0.0), -1.0, 16) == math.inf


# --- Accumulate ------------------------------------------------------------------------------------------------------


def test_accumulation() -> None:
    assert shadows.accumulated([0.2, 0.4, 0.6, 0.0, 0.3], "float") == pytest.approx(0.3)
    assert shadows.accumulated([1.0] * 9, "unorm8") == 252 / 255  # alpha is 28 / 255
    assert shadows.accumulated([1.0] * 200, "unorm8") == 200 / 255
    assert shadows.accumulated([1.0] * 170, "unorm8") == 1.0  # alpha 1.5 / 255 rounds to 2: saturates


def test_soft_shadow_counts_the_samples_that_the_plate_hides() -> None:
    scene = soft_scene(0.6)
    params = parameters(method="direct", light_samples=9, map_size=64, content="mask")
    samples = shadow_light.light_samples_of(scene, params)
    stages, _, _ = shadows.render(scene, params)
    assert stages["warp.image"].shape == (9, 64, 64)
    assert stages["project.shadow"].shape == (9, 18, 24)
    assert stages["project.coord"].shape == (9, 18, 24, 3)
    seen = set()
    for pixel, world in floor_points(scene).items():
        inside = [lit_by_rays(scene, world, sample.position) for sample in samples]
        if min(abs(d) for d in inside) > 0.06:  # one and a half of the map's texels, which are 0.045 wide on the plate
            hidden = sum(d > 0 for d in inside)
            assert stages["accumulate.shadow"][pixel] == pytest.approx(hidden / 9, abs=1e-9)
            seen.add(hidden)
    assert {0, 1, 2, 3, 4, 6} <= seen


def test_warped_soft_shadow_is_near_the_direct_one_with_controls_that_follow_the_plate() -> None:
    scene = soft_scene(0.3)
    params = parameters(light_samples=9, map_size=64)
    positions, images = shadows.prepare(scene, params)
    truth = shadows.render(scene, parameters(method="direct", light_samples=9, map_size=64))[0]["accumulate.shadow"]

    def difference(controls: Any) -> float:
        warped = shadows.render(scene, params, controls, (positions, images))[0]["accumulate.shadow"]
        shaded = (warped > 0) | (truth > 0)
        return float(np.abs(warped - truth)[shaded].mean())

    assert difference(rigid_controls(scene, positions)) < 0.05
    assert difference(same_controls(4, 4)) > 0.15


def test_one_sample_has_no_sample_axis() -> None:
    scene = example()
    stages, color, depth = shadows.render(scene, parameters(map_size=16), same_controls(2, 2))
    shapes = {name: array.shape for name, array in stages.items()}
    assert shapes == {
        "maps.positions": (3, 3, 2),
        "maps.image": (3, 3, 16, 16),
        "controls": (3, 3, 2, 2, 2),
        "warp.cell": (2,),
        "warp.fraction": (2,),
        "warp.row_grids": (2, 2, 2, 2),
        "warp.rows": (2, 16, 16),
        "warp.grid": (2, 2, 2),
        "warp.image": (16, 16),
        "project.coord": (18, 24, 3),
        "project.shadow": (18, 24),
        "project.margin": (18, 24),
        "project.texel_margin": (18, 24),
        "accumulate.shadow": (18, 24),
    }
    assert stages["warp.cell"].dtype == np.int32
    assert color.shape == (18, 24, 3)
    assert depth.shape == (18, 24)
