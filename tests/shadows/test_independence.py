"""What a warp costs does not depend on the caster: its triangles are not even looked at."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ibr_ref.scene import Mesh
from ibr_ref.shadows import Maps, prepare, prepared, samples, shadow_maps
from tests.shadows.scenes import box, light, params, scene


def test_a_warp_does_not_touch_the_caster(monkeypatch: pytest.MonkeyPatch) -> None:
    """After the first map, neither its digest nor its corners are asked for."""
    seen, small = scene(), params(light_samples=5)
    maps = prepare(seen, small, controls="bounds")
    first = shadow_maps(seen, small, maps=maps)

    def refuse(*_: Any) -> None:
        raise AssertionError("the caster's triangles were looked at")

    monkeypatch.setattr(samples, "contains", refuse)
    monkeypatch.setattr(prepared.hashlib, "sha256", refuse)
    assert np.array_equal(shadow_maps(seen, small, maps=maps), first)
    assert shadow_maps(replace(seen, offset=(-0.4, 0.3)), small, maps=maps).shape == first.shape


def test_maps_of_another_caster_are_told_apart() -> None:
    """By what it is, not by which object holds it."""
    small = params()
    maps = prepare(scene(), small, controls="bounds")
    same = Mesh(vertices=np.array(box().vertices), triangles=np.array(box().triangles))
    assert isinstance(maps, Maps)
    assert shadow_maps(scene(caster=same), small, maps=maps).shape == (1, 64, 64)
    with pytest.raises(ValueError, match=r"^maps: "):
        shadow_maps(scene(caster=box(0.41)), small, maps=maps)


@pytest.mark.parametrize("far", [0.0, 1e6])
def test_a_light_on_the_caster_is_found_wherever_both_are(far: float) -> None:
    """In the middle of its top, to the last bit or one beside; above it there is nothing to find."""
    moved = np.array([far, 0.0, 0.0])
    caster = Mesh(vertices=np.asarray(box(0.4).vertices) + moved, triangles=box(0.4).triangles)
    for height, wrong in ((0.4, True), (0.0, True), (0.9, False)):
        at = moved + np.array([0.2, -0.1, height])
        lamp = light(position=at, target=at - (0.0, 0.0, 2.0))
        seen = scene(caster=caster, light=lamp)
        if wrong:
            with pytest.raises(ValueError, match=r"^light\.position: "):
                shadow_maps(seen, params(method="direct"))
        else:
            assert shadow_maps(seen, params(method="direct")).any()
