"""`READ_BY` is what the methods do: a field that it denies to a method changes nothing, one that it grants does."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ibr_ref import displacement
from ibr_ref.displacement.inputs import METHODS, READ_BY
from ibr_ref.io import Frame
from ibr_ref.scene import Light
from tests.displacement.scenes import block, camera, square

OTHERS = {
    "linear_steps": 3, "binary_steps": 1, "steep_threshold": 0.95, "interval": "volume", "faces": "base", "depth": "polygon",
    "lod_bias": 3.0, "min_steps": 2, "max_steps": 9, "distance_layers": 3,
}  # fmt: skip


def changed(method: str, field: str, value: Any) -> set[str]:
    """Names of the arrays that another value of a field changes."""
    polygon = square(block(12, 16, 4, 8, 0.9), facade_map=np.full((2, 2, 3), (1.0, 0.0, 0.0)))
    scene = displacement.Scene(polygons=[polygon], camera=camera(), light=Light(direction=(0.5, -0.8, 0.6)))
    before = arrays(displacement.render(scene, displacement.Params(method=method)))
    if field == "facade_map":
        scene, params = replace(scene, polygons=[replace(polygon, facade_map=None)]), {}
    else:
        params = {field: value}
    after = arrays(displacement.render(scene, displacement.Params(method=method, **params)))
    return {name for name in after if not same(before.get(name), after[name])}


def arrays(frame: Frame) -> dict[str, Any]:
    return {**frame.stages, "color": frame.color, "depth": frame.depth}


def same(a: Any, b: Any) -> bool:
    return a is not None and a.shape == b.shape and np.array_equal(a, b, equal_nan=True)


@pytest.mark.parametrize("method", METHODS)
def test_the_table_is_what_the_methods_do(method: str) -> None:
    assert set(READ_BY) == {*OTHERS, "facade_map"}
    for field, methods in READ_BY.items():
        found = changed(method, field, OTHERS.get(field)) - {"march.hit_index"}
        assert bool(found) == (method in methods), (field, found)
