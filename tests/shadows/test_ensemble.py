"""shadows/method.md, "Several casters, several lights"."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ibr_ref import shadows
from ibr_ref.io import Frame
from ibr_ref.scene import Camera
from ibr_ref.shadows import Caster, Ensemble, prepare_ensemble, render, render_ensemble
from tests.agreement import arrays_of, differences, flat
from tests.naive import shadow_ensemble as naive
from tests.shadows.golden_scenes import painted
from tests.shadows.scenes import Array, ball, box, light, params, plate, scene

OVERHEAD = Camera.orthographic(
    eye=(0, 0, 9), target=(0, 0, 0), up=(0, 1, 0), view_height=3.6, near=1, far=20, width=72, height=72
)
DIRECT = params(method="direct", map_size=256)


def caster(**changes: Any) -> Caster:
    values = {
        "mesh": box(0.3, color=(0.8, 0.3, 0.1)),
        "offset_range": ((-0.9, 0.9), (-0.9, 0.9)),
        "offset": (0.2, -0.1),
    }
    return Caster(**{**values, **changes})


def ensemble(*casters: Caster, **changes: Any) -> Ensemble:
    one = scene()
    values = {"receivers": one.receivers, "casters": casters or [caster()], "lights": [light()], "camera": one.camera}
    return Ensemble(**{**values, **changes})


LEFT, RIGHT = caster(offset=(-0.7, 0.1)), caster(mesh=ball(0.3, 16), offset=(0.7, -0.1))
ASIDE = light(position=(-1.5, 0.5, 3.5), half_edges=((0.1, 0, 0), (0, 0.1, 0)))


def shadow_of(frame: Frame, of: int = 0) -> Array:
    return np.asarray(frame.stages[f"light{of}.accumulate.shadow"])


# --- One of each -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes",
    [
        {"light_samples": 5},
        {"light_samples": 9, "accumulation": "unorm8"},
        {"method": "direct", "content": "depth", "pcf": True},
        {"method": "grid", "grid_size": 3},
        {"light_samples": [(0.1, 0.0, 4.0)], "interpolation": "projective"},
    ],
    ids=str,
)
def test_one_caster_and_one_light_are_a_scene(changes: dict[str, Any]) -> None:
    """To the last bit, with all stages."""
    both, chosen = ensemble(), params(**changes)
    maps = prepare_ensemble(both, chosen, controls="bounds") if chosen.method == "warp" else None
    alone = render(both.scene(0, 0), chosen, maps=maps and maps[0][0])
    frame = render_ensemble(both, chosen, maps=maps)
    assert np.array_equal(frame.color, alone.color)
    assert np.array_equal(frame.depth, alone.depth)
    for name, array in alone.stages.items():
        whole = name == "accumulate.shadow"
        assert np.array_equal(frame.stages[f"light0.{name}" if whole else f"light0.caster0.{name}"], array)


# --- The twin --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("number", range(8))
def test_drawn_ensembles_agree_with_the_naive_twin(number: int, one_thread: None) -> None:
    draw = np.random.RandomState(number)
    casters = [
        caster(
            mesh=(painted(box(draw.uniform(0.2, 0.5)), i), ball(0.4, 6), plate(0.4, draw.uniform(-0.5, 0.5)))[i],
            offset=draw.uniform(-0.8, 0.8, 2),
            offset_axes=((1.0, draw.uniform(-0.2, 0.2), 0.0), (0.0, draw.uniform(0.7, 1.3), 0.0)),
        )
        for i in draw.permutation(3)[: 1 + number % 3]
    ]
    lamps = [light(position=(*draw.uniform(-1.0, 1.0, 2), 4.0)) for _ in range(1 + number // 2 % 3)]
    camera = Camera.look_at(eye=(0.5, -4, 2.5), target=(0, 0, -0.7), near=0.1, far=20, width=24, height=18)
    both = ensemble(*casters, lights=lamps, powers=draw.uniform(0.0, 0.8, len(lamps)), camera=camera)
    methods = [{"policy": "dissolve"}, {"method": "direct", "content": "depth", "bias": 0.01}, {"policy": "nearest"}]
    chosen = params(map_size=24, light_samples=(1, 5)[number % 2], accumulation=("float", "unorm8")[number // 4])
    chosen = replace(chosen, **methods[number % 3])
    maps = prepare_ensemble(both, chosen, controls="bounds") if chosen.method == "warp" else None
    frame = render_ensemble(both, chosen, maps=maps)
    stages, color, depth = naive.render(both, chosen, maps and [[each.controls for each in row] for row in maps])
    report = differences(arrays_of(frame), {**flat(stages), "color": color, "depth": depth})
    assert not report, report
    bare = render_ensemble(both, chosen, maps=maps, stages=False)
    assert np.array_equal(bare.color, frame.color)
    assert not bare.stages


# --- Closed forms ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("samples", [1, 9])
def test_the_shadows_of_casters_apart_are_those_of_each(samples: int) -> None:
    """On the floor, where neither caster is seen."""
    chosen = replace(DIRECT, light_samples=samples)
    frames = [render_ensemble(ensemble(*who, camera=OVERHEAD), chosen) for who in ((LEFT,), (RIGHT,), (LEFT, RIGHT))]
    left, right, both = map(shadow_of, frames)
    floor = np.logical_and.reduce([frame.depth > 0.44 for frame in frames])
    assert (left[floor] > 0.5).sum() > 20
    assert (right[floor] > 0.5).sum() > 20
    assert not ((left > 0.0) & (right > 0.0)).any()
    assert np.array_equal(both[floor], (left + right)[floor])


def test_the_shadow_of_a_pair_is_what_rays_through_either_reach() -> None:
    """Two cubes that overlap as the light sees them; by slabs, from the floor to the light."""
    lamp, at = light(position=(1.0, -1.5, 3.0), vertical_fov=60.0), ((-0.1, 0.3), (0.2, 0.1))
    frame = render_ensemble(ensemble(*(caster(offset=o) for o in at), lights=[lamp], camera=OVERHEAD), DIRECT)
    grid = ((np.arange(72) + 0.5) / 72 - 0.5) * 3.6
    x, y = np.meshgrid(grid, -grid)
    l, p = np.array([1.0, -1.5, 3.0]), np.stack([x, y, np.full(x.shape, -1.0)], axis=-1)
    gaps = []
    for offset in at:
        near, far = ((np.array([*offset, 0.0]) + side * 0.3 - p) / (l - p) for side in (-1, 1))
        enters, leaves = np.minimum(near, far).max(axis=-1), np.maximum(near, far).min(axis=-1)
        gaps.append(np.minimum(leaves, 1.0) - np.maximum(enters, 0.0))
    gap = np.maximum(*gaps)
    sure = (np.abs(frame.depth - 9.0 / 19.0) < 1e-9) & (np.abs(gap) > 0.01)
    assert sure.mean() > 0.7
    assert np.array_equal(shadow_of(frame)[sure] > 0.5, gap[sure] > 0.0)
    assert ((gaps[0] > 0.01) & (gaps[1] > 0.01) & sure).sum() > 50


def test_the_same_caster_twice_is_no_darker() -> None:
    once, twice = (render_ensemble(ensemble(*[LEFT] * count), replace(DIRECT, light_samples=5)) for count in (1, 2))
    assert np.array_equal(once.color, twice.color)
    assert ((shadow_of(once) > 0.0) & (shadow_of(once) < 1.0)).any()


def test_two_lights_at_one_place_double_the_light() -> None:
    """And at half the power each they are one."""
    one, double, halved = (
        render_ensemble(ensemble(LEFT, RIGHT, lights=[ASIDE] * count, powers=powers, ambient=0.1), DIRECT)
        for count, powers in ((1, None), (2, None), (2, (0.5, 0.5)))
    )
    dark = render_ensemble(ensemble(LEFT, RIGHT, lights=[ASIDE], powers=[0.0], ambient=0.1), DIRECT)
    assert np.abs(double.color - np.minimum(1.0, 2.0 * one.color - dark.color)).max() < 1e-15
    assert np.abs(halved.color - one.color).max() < 1e-15
    assert (double.color == 1.0).any(), "brighter than 1 is 1"


def test_each_light_adds_what_it_adds_alone() -> None:
    def drawn(powers: tuple[float, float]) -> Array:
        return render_ensemble(ensemble(LEFT, RIGHT, lights=[light(), ASIDE], powers=powers), DIRECT).color

    dark, first, second, both = map(drawn, ((0.0, 0.0), (0.6, 0.0), (0.0, 0.4), (0.6, 0.4)))
    assert np.abs((both - dark) - (first - dark) - (second - dark)).max() < 1e-15
    assert len({tuple(frame.ravel()[:1000]) for frame in (dark, first, second)}) == 3


def test_casters_are_lit_by_masks_and_shadowed_by_depths() -> None:
    """A small cube under a large one: masks do not know which is before the other."""
    low = caster(mesh=box(0.2), offset=(0.0, 0.0))
    high = caster(mesh=plate(0.5, 1.0), offset=(0.0, 0.0))
    below = Camera.look_at(eye=(0, -3, 0.8), target=(0, 0, 0), near=0.1, far=20, width=48, height=36)
    tops = []
    for content in ("mask", "depth"):
        chosen = replace(DIRECT, content=content, bias=0.01)
        frame = render_ensemble(ensemble(low, high, camera=below), chosen)
        coord = np.asarray(frame.stages["light0.caster0.project.coord"])[..., 2]
        top = np.abs(coord - (8.0 - 8.0 / 3.8) / 7.0) < 1e-6  # z = 0.2, 3.8 from the light, between 1 and 8
        assert top.sum() > 5
        tops.append(shadow_of(frame)[top])
    assert not tops[0].any()
    assert tops[1].all()


# --- Where casters stand ---------------------------------------------------------------------------------------------


def test_a_caster_over_nothing_shadows_nothing() -> None:
    """Beside the only receiver, where the light's rays through it meet none."""
    lonely = ensemble(caster(offset=(0.9, 0.9)), receivers=[plate(0.3, -0.4)], camera=OVERHEAD)
    frame = render_ensemble(lonely, DIRECT)
    assert (frame.depth < 1.0).mean() > 0.03
    assert not shadow_of(frame).any()
    assert not shadows.cut_by_light(lonely.scene(0, 0), DIRECT).cut


def test_the_shadow_of_a_caster_on_the_floor_begins_at_its_foot() -> None:
    """Seen from above the shadow is what the rays through the cube's top cover, down to its walls, without a gap."""
    standing = caster(mesh=box(0.3), offset=(0.0, 0.0))
    lamp = light(position=(-2.0, 0.0, 4.0), half_edges=np.zeros((2, 3)), vertical_fov=70.0)
    frame = render_ensemble(
        ensemble(standing, receivers=[plate(3.0, -0.3)], lights=[lamp], camera=OVERHEAD), replace(DIRECT, map_size=512)
    )
    middle = shadow_of(frame)[36]
    x = ((np.arange(72) + 0.5) / 72 - 0.5) * 3.6
    reach = -2.0 + 2.3 * (4.3 / 3.7)  # through the far upper edge (0.3, 0.3), down to -0.3
    floor = x > 0.3
    assert np.array_equal(middle[floor] > 0.5, x[floor] < reach)
    assert (middle[floor] > 0.5).sum() > 5


def test_what_the_frustum_cuts_is_said_of_the_caster_that_it_cuts() -> None:
    narrow = light(vertical_fov=20.0)  # 0.7 to either side at the height of the casters
    both = ensemble(LEFT, caster(offset=(0.0, 0.0)), lights=[narrow])
    cuts = [shadows.cut_by_light(both.scene(i, 0), DIRECT) for i in range(2)]
    assert (cuts[0].cut, cuts[0].beside, cuts[0].near, cuts[0].far) == (10, 10, 0, 0)
    assert cuts[1].cut == 0


# --- Bad input -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"casters": []}, "casters: found 0, allowed: 1 to 64"),
        ({"casters": [caster(), box()]}, r"casters\[1\]: found 'Mesh', allowed: Caster"),
        ({"casters": 3}, "casters: found 'int'"),
        ({"lights": [light()] * 65}, "lights: found 65"),
        ({"lights": [light(), 1]}, r"lights\[1\]: found 'int', allowed: AreaLight"),
        ({"powers": [1.0, 2.0]}, "powers: found .*, allowed: 1 finite"),
        ({"powers": [-1.0]}, r"powers\[0\]: found -1.0, allowed: a finite number >= 0"),
        ({"casters": [caster(), caster(offset=(2, 0))]}, r"casters\[1\]: offset: found \(2.0, 0.0\)"),
        (
            {"lights": [light(), light(half_edges=((0, 0, 1), (0, 1, 0)))]},
            r"lights\[1\]: light.half_edges\[0\]: found .*, allowed: a vector in the plane",
        ),
        ({"ambient": 2.0}, "ambient: found 2.0"),
        ({"receivers": []}, "receivers: found 'none'"),
    ],
    ids=str,
)
def test_bad_ensembles_are_named(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=f"^{words}"):
        ensemble(**changes)


def test_what_only_together_is_not_allowed() -> None:
    two = ensemble(lights=[light(), ASIDE])
    with pytest.raises(ValueError, match=r"^light_samples: found '1 positions', allowed: 1 \| 5 \| 9 with several"):
        render_ensemble(two, params(light_samples=[(0.0, 0.0, 4.0)]))
    with pytest.raises(ValueError, match=r"^maps: found '\[1\] of the casters', allowed: \[2\]"):
        render_ensemble(two, params(), maps=[[None]])  # type: ignore[list-item]
    others = prepare_ensemble(ensemble(RIGHT, lights=[light(), ASIDE]), params(), controls="bounds")
    with pytest.raises(ValueError, match=r"^lights\[0\]: maps: found 'those of another caster"):
        render_ensemble(two, params(), maps=others)
    inside = ensemble(
        LEFT, caster(mesh=box(3.0), offset_range=((-1, 1), (-1, 1))), lights=[light(position=(0, 0, 2.5))]
    )
    with pytest.raises(ValueError, match=r"^casters\[1\]: light.position: found .* outside the caster"):
        render_ensemble(inside, DIRECT)
