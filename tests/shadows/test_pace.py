"""The pace between two maps: even, as in the paper, or that of the caster's middle under perspective."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ibr_ref.pipeline.transform import transformed
from ibr_ref.shadows import Params, Scene, folds, maps, pace, prepare, render
from ibr_ref.shadows.prepared import view_of
from tests.shadows.quality import map_quality
from tests.shadows.scenes import box, light, params, plate, scene

LOW = light(position=(-1.6, -1.3, 2.0), target=(0.0, 0.0, 0.0), vertical_fov=75.0, near=0.3)
"""Near and aside: depths differ by half of themselves over the range."""

WIDE = ((-0.6, 0.7), (-0.7, 0.5))


def slanted(**changes: Any) -> Scene:
    return scene(**{"light": LOW, "offset_range": WIDE, "offset": (0.3, -0.35), **changes})


def paced(**changes: Any) -> Params:
    return params(interpolation="projective", **changes)


def stages(given: Scene, parameters: Params) -> dict[str, Any]:
    made = prepare(given, parameters, controls="bounds")
    return dict(render(given, parameters, maps=made).stages)


def test_what_lies_at_the_middle_s_depth_is_where_the_shares_say() -> None:
    """The projection of the caster's middle, interpolated between its places in the four maps around: exact."""
    given = slanted()
    kept = stages(given, paced())
    view = view_of(given, 64)
    middle = given.caster.bounds.mean(axis=0)

    def seen(offset: Any) -> Any:
        at = (middle + offset[0] * given.axes[0] + offset[1] * given.axes[1])[None]
        clip = transformed(view.clip_from_view, transformed(view.view_from_world, at))[0]
        return clip[:2] / clip[3]

    (i, j), (upper, lower, across) = kept["warp.cell"], kept["warp.shares"]
    corners = [[seen(kept["maps.positions"][j + k, i + n]) for n in range(2)] for k in range(2)]
    rows = [(1 - s) * row[0] + s * row[1] for s, row in zip((upper, lower), corners, strict=True)]
    found = (1 - across) * rows[0] + across * rows[1]
    assert np.allclose(found, seen(given.offset), atol=1e-12)
    s, t = kept["warp.fraction"]
    even = [(1 - s) * row[0] + s * row[1] for row in corners]
    assert np.abs((1 - t) * even[0] + t * even[1] - seen(given.offset)).max() > 0.004


def test_shares_by_hand() -> None:
    assert pace.share(0.5, 1.0, 3.0) == 0.75
    assert [pace.share(f, 2.0, 5.0) for f in (0.0, 1.0)] == [0.0, 1.0]
    assert pace.shares(np.array([0.5, 0.25]), None).tolist() == [0.5, 0.5, 0.25]
    assert pace.shares(np.array([0.5, 0.5]), np.array([(1.0, 3.0), (3.0, 1.0)])).tolist() == [0.75, 0.25, 0.5]
    weights = pace.weights(np.array([(0.5, 0.5)]), np.array([(1.0, 2.0), (3.0, 4.0)]))
    assert np.allclose(weights, [[0.1, 0.2, 0.3, 0.4]])


def test_the_even_pace_is_the_default_and_has_no_further_arrays() -> None:
    assert Params().interpolation == "linear"
    even, own = stages(slanted(), params()), stages(slanted(), paced())
    assert set(own) - set(even) == {"maps.depths", "warp.shares"}
    assert np.abs(own["warp.grid"] - even["warp.grid"]).max() > 0.003
    assert own["maps.depths"].shape == (3, 3)


def test_every_sample_has_its_shares() -> None:
    kept = stages(slanted(), paced(light_samples=5))
    assert kept["warp.shares"].shape == (5, 3)
    assert kept["maps.depths"].shape == (3, 3)


@pytest.mark.parametrize("controls", ["bounds", "fast"])
def test_a_near_light_s_maps_are_nearer_to_the_rendered_ones(controls: str) -> None:
    random = np.random.RandomState(2)
    low, high = np.array(WIDE).T
    scenes = [slanted(offset=o) for o in random.uniform(low, high, (16, 2))]
    made = {given.interpolation: prepare(scenes[0], given, controls=controls) for given in (params(), paced())}
    found = {name: map_quality(scenes, params(interpolation=name), each) for name, each in made.items()}
    assert found["projective"][0] > found["linear"][0] + 0.005, found
    if made["linear"].choice:
        assert {name: each.choice.interpolation for name, each in made.items() if each.choice} == {
            "linear": "linear",
            "projective": "projective",
        }


def test_a_flat_caster_across_the_light_s_axis_moves_as_it_should() -> None:
    """All of it is at the middle's depth: of the projective pace only texels are left, of the even one much more."""
    still = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    straight = light(position=(0.0, 0.0, 2.0), target=(0.0, 0.0, 0.0), vertical_fov=75.0, near=0.3, half_edges=still)
    axes = ((1.0, 0.0, 0.6), (0.0, 1.0, 0.0))  # towards the light as it goes along x
    given = scene(
        light=straight,
        caster=plate(0.3),
        offset_axes=axes,
        offset_range=((-0.6, 0.6), (-0.2, 0.2)),
        offset=(0.0, 0.0),
        receivers=[plate(6.0, -2.0)],
    )
    scenes = [replace(given, offset=(x, 0.1)) for x in (-0.4, -0.3, -0.2, 0.2, 0.3, 0.4)]
    large = {"map_size": 128, "map_samples": 4}
    found = {
        name: map_quality(
            scenes, params(interpolation=name, **large), prepare(given, params(**large), controls="bounds")
        )
        for name in ("linear", "projective")
    }
    assert found["projective"][1] > 0.94, found
    assert found["linear"][1] < 0.9, found


def test_a_caster_that_is_not_in_front_of_the_light_has_no_such_pace() -> None:
    beside = light(position=(0.0, 0.0, 0.6), target=(1.0, 0.0, 0.5), half_edges=((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    given = scene(light=beside, caster=box(0.1), offset_range=((-0.5, 0.5), (-0.4, 0.4)))
    prepare(given, params(), controls="identity")
    made = prepare(given, paced(), controls="identity")
    with pytest.raises(ValueError, match=r"interpolation.*in front of the light"):
        render(given, paced(), maps=made)
    with pytest.raises(ValueError, match="interpolation"):
        prepare(given, paced(), controls="fast")


def test_another_word_is_refused() -> None:
    with pytest.raises(ValueError, match="interpolation"):
        Params(interpolation="even")


def test_areas_at_the_projective_pace_have_the_coefficients_sign() -> None:
    """Times the square of what weights are divided by, the area is the polynomial with these coefficients."""
    random = np.random.RandomState(3)
    depths = random.uniform(1.0, 4.0, (3, 3))
    corners = random.random_sample((4, 4, 3, 2))  # one triangle a cell
    found = folds.coefficients(corners, folds.forms_of(depths)).reshape(4, 3, 3)
    for cell, (j, i) in enumerate((j, i) for j in range(2) for i in range(2)):
        around = pace.cell_of(depths, i, j)
        for s, t in random.random_sample((5, 2)):
            weights = pace.weights(np.array([(s, t)]), around)[0]
            p = np.einsum("k,kad->ad", weights, corners[cell])
            e, f = p[1] - p[0], p[2] - p[0]
            along = [np.array([(1 - x) ** 2, 2 * x * (1 - x), x**2]) for x in (t, s)]
            polynomial = np.einsum("mn,m,n->", found[cell], *along)
            even = pace.weights(np.array([(s, t)]), None)[0]
            total = float((even * around.reshape(4)).sum()) / around.mean()
            assert polynomial == pytest.approx((e[0] * f[1] - e[1] * f[0]) * total**2, abs=1e-12)


def test_boxes_of_the_caster_reach_beyond_the_map() -> None:
    given = scene(light=light(vertical_fov=20.0), offset_range=((-1.0, 1.0), (-0.5, 0.5)))
    made = prepare(given, params(), controls="identity")
    boxes = maps.projected_boxes(view_of(given, 64), made.positions)
    assert boxes is not None
    assert boxes[0, 0, 0, 0] < 0.0
    assert boxes[0, 2, 0, 1] > 1.0
    assert (boxes[..., 1] > boxes[..., 0]).all()
