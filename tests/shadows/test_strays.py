"""Vertices of no triangle, as many files have, change no picture and no window."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ibr_ref import Mesh, models, shadows
from tests.shadows.scenes import box, params, scene

STRAYS = np.array([(100.0, 100.0, 100.0), (-3.0, 0.0, 50.0), (0.0, 0.0, -1e6)])


def with_strays(mesh: Mesh, strays: np.ndarray = STRAYS) -> Mesh:
    """The first of all vertices and the last ones are strays."""
    vertices = np.concatenate([strays[:1], np.asarray(mesh.vertices), strays])
    color = np.asarray(mesh.color)
    if color.ndim == 2:
        color = np.concatenate([color[:1] * 0.5, color, np.zeros_like(strays)])
    return Mesh(vertices=vertices, triangles=np.asarray(mesh.triangles) + 1, color=color)


@pytest.mark.parametrize("strays", [STRAYS, [(1e308, -1e308, 1e308)], [(0.0, 0.0, 0.0)]], ids=["far", "huge", "inside"])
def test_the_stage_is_set_for_the_triangles(strays: Any) -> None:
    mesh = models.kettle()
    wanted, found = (models.shadow_stage(m).caster for m in (mesh, with_strays(mesh, np.array(strays))))
    np.testing.assert_array_equal(found.vertices, wanted.vertices)
    np.testing.assert_array_equal(found.triangles, wanted.triangles)
    np.testing.assert_array_equal(found.color, wanted.color)


@pytest.mark.parametrize("method", ["warp", "direct", "pcss"])
def test_the_same_shadow(method: str) -> None:
    chosen = params(method=method)
    frames = [shadows.render(scene(caster=caster), chosen) for caster in (box(), with_strays(box()))]
    np.testing.assert_array_equal(frames[0].color, frames[1].color)


@pytest.mark.parametrize("method", ["traced", "convolution"])
def test_the_same_soft_shadow(method: str) -> None:
    """Map and light plane once reached to the farthest vertex, and a vertex behind the light was refused."""
    chosen = shadows.SoftParams(method=method)
    frames = [shadows.render_soft(scene(caster=caster), chosen) for caster in (box(), with_strays(box()))]
    for name, stage in frames[0].stages.items():
        np.testing.assert_array_equal(stage, frames[1].stages[name], err_msg=name)
    np.testing.assert_array_equal(frames[0].color, frames[1].color)


def test_strays_of_receivers_change_nothing() -> None:
    plain = scene()
    strewn = replace(plain, receivers=[with_strays(mesh) for mesh in plain.receivers])
    frames = [shadows.render(each, params(method="direct")) for each in (plain, strewn)]
    np.testing.assert_array_equal(frames[0].color, frames[1].color)
