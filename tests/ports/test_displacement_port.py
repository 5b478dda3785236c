"""The GLSL port on a real OpenGL, against the reference: nothing differs where no float32 rounding can turn a decision."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import ibr_ref
from ibr_ref import displacement, models

moderngl = pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")

from tests.ports.displacement import Port  # noqa: E402

ROUNDING = 1e-6
"""Heights and texture coordinates of about 1 after some ten float32 operations of 2^-24 each."""
SPREAD = 4.0
"""How much farther a sample p(t) may be off than C is: A and B are C and a multiple of the way to the eye, which is more
than three times as high as the volume."""


def clear_pixels(stages: dict[str, np.ndarray], ported: dict[str, np.ndarray], heights: np.ndarray) -> np.ndarray:
    """Pixels whose decisions neither rounding nor the port's own C (a driver may interpolate unsnapped) can turn."""
    off = SPREAD * np.nan_to_num(abs(stages["raster.patch"] - ported["raster.patch"]).max(axis=-1))
    slope = sum(abs(np.diff(heights, axis=axis)).max() * heights.shape[axis] for axis in (0, 1))
    clear = stages["march.margin"] > slope * off + ROUNDING
    return clear & (stages["march.domain_margin"] > off + ROUNDING)


@pytest.fixture(scope="module")
def port() -> Iterator[Port]:
    try:
        yield Port()
    except Exception as error:
        pytest.skip(f"no headless OpenGL 4.5: {error}")


def scene(**light: object) -> displacement.Scene:
    camera = ibr_ref.Camera.look_at(eye=(0.6, -0.75, 0.65), target=(0, 0, 0), near=0.1, far=10, width=320, height=240)
    lamp = ibr_ref.Light(position=(1.5, -0.5, 2.0), **light)  # type: ignore[arg-type]
    return displacement.Scene(polygons=[models.box()], camera=camera, light=lamp)


@pytest.mark.parametrize("steps", [10, 50])
def test_the_port_agrees_where_the_margins_are_clear(port: Port, steps: int) -> None:
    params = displacement.Params(linear_steps=steps)
    reference = displacement.render(scene(), params)
    drawn = port.render(scene(), params, stages=True)
    stages, ported = reference.stages, drawn.stages
    clear = clear_pixels(stages, ported, np.asarray(models.box().height_map))
    assert clear.sum() > 0.5 * (stages["raster.face"] >= 0).sum(), "hardly a pixel is certain: the test says nothing"
    covered = (stages["raster.face"] >= 0) | (ported["raster.face"] >= 0)
    # Coverage is a decision too; the pixels of the faces' outlines are few.
    assert (stages["raster.face"] != ported["raster.face"]).sum() < 1e-3 * covered.sum()
    clear &= stages["raster.face"] == ported["raster.face"]
    for name in ("march.linear_index", "march.hit_index"):
        wrong = clear & (stages[name] != ported[name])
        assert not wrong.any(), (name, wrong.sum(), np.argwhere(wrong)[:3].tolist())
    same = clear & (stages["march.hit_index"] >= 0)
    assert abs(stages["march.hit"] - ported["march.hit"])[same].max() < 1e-4
    different = (abs(reference.color - drawn.color) > 2 / 255).any(axis=-1)
    assert different.mean() < 0.005


def test_a_broken_port_is_noticed(port: Port) -> None:
    """The same comparison, with a search that takes one step more: it must not pass."""
    reference = displacement.render(scene(), displacement.Params(linear_steps=10))
    drawn = port.render(scene(), displacement.Params(linear_steps=11), stages=True)
    clear = clear_pixels(reference.stages, drawn.stages, np.asarray(models.box().height_map))
    wrong = clear & (reference.stages["march.linear_index"] != drawn.stages["march.linear_index"])
    assert wrong.sum() > 100
