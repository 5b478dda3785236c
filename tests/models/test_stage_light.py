"""The stage's light at places of one's own: its maps hold the caster, wherever that stands."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref import Mesh, models, shadows

POLE = Mesh(vertices=[[0, 0, 0], [0.2, 0, 0], [0, 0.3, 1]], triangles=[[0, 1, 2]], color=(0.5, 0.5, 0.5))
PLACES = [(-1, -1.2, 5), (2, 1, 4), (3, 0, 0.3), (0, -4, -0.2), (0, 0, 6), (0, 5, 0)]


@pytest.mark.parametrize("size", [0.0, 0.2, (0.3, 0.1), (0.0, 0.4)])
@pytest.mark.parametrize("target", [None, (0, 0, 0), (1, 1, -0.5)])
@pytest.mark.parametrize("position", PLACES)
def test_nothing_of_the_caster_is_cut(
    position: tuple[float, ...], target: tuple[float, ...] | None, size: float | tuple[float, float]
) -> None:
    """In the nine maps for nine samples; and not much more room than that needs: at half the field of view it is cut."""
    stage = models.shadow_stage(POLE, light_position=position, light_target=target, light_size=size, offset=(0.6, -0.6))
    light = stage.light
    assert np.asarray(light.position).tolist() == list(position)
    assert np.asarray(light.target).tolist() == list(target or (0, 0, 0))
    a, b = (size, size) if isinstance(size, float) else size
    assert np.asarray(light.half_edges).tolist() == [[a, 0, 0], [0, b, 0]]
    params = shadows.Params(light_samples=9)
    assert shadows.cut_by_light(stage, params, of_maps=True).cut == 0
    narrow = models.shadow_stage(POLE, light_position=position, light_target=target, light_size=size)
    half = shadows.AreaLight(
        position=light.position, target=light.target, up=light.up, vertical_fov=light.vertical_fov / 2,
        near=light.near, far=light.far, half_edges=light.half_edges,
    )  # fmt: skip
    fields = {name: getattr(narrow, name) for name in ("receivers", "caster", "camera", "offset_range", "offset")}
    assert shadows.cut_by_light(shadows.Scene(**fields, light=half), params, of_maps=True).cut > 0


def test_all_that_is_lit_lies_between_its_planes() -> None:
    stage = models.shadow_stage(POLE, light_position=(2, 1, 4), light_target=(1, 0, 0))
    camera = stage.light.camera(8)
    for mesh in stage.receivers:
        depths = -(np.asarray(mesh.vertices) @ camera.view_from_world[2, :3] + camera.view_from_world[2, 3])
        assert depths.max() < stage.light.far


def test_the_stage_keeps_its_own_light() -> None:
    light = models.shadow_stage(POLE).light
    assert (light.vertical_fov, light.near, light.far) == (27.0, 0.5, 12.0)
    assert np.asarray(light.position).tolist() == [-1.0, -1.2, 5.0]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"light_position": (0, 0, 0)}, "light_target"),
        ({"light_position": (0.5, 0.2, 0.1), "light_target": (0, 0, -0.4)}, r"light_position: found \[0.5, 0.2, 0.1\]"),
        ({"light_position": (0, 0, 5), "light_target": (0, 0, 9)}, "light_position: found"),
        ({"light_position": (0, 0)}, "light_position"),
        ({"light_target": (0, 0, float("nan"))}, "light_target"),
        ({"light_size": -1}, "light_size"),
        ({"light_size": (0.1, -0.1)}, r"light_size: found \[0.1, -0.1\], allowed: numbers >= 0"),
        ({"light_size": (0.1, 0.1, 0.1)}, "light_size"),
    ],
)
def test_lights_that_are_none(options: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        models.shadow_stage(POLE, **options)
