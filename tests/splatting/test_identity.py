"""A reference image seen by its own camera, at a width of one pixel, is itself: colour by colour, bit for bit.

What that needs: the point of a pixel, taken into the world and back, must land within 1/512 pixel of the pixel's centre, so
that it is snapped there; and its depth must lie between the camera's planes. The way back ends within rounding, some
1e-12 pixel for cameras at distances like those here. (At 1e12 world units from the origin it would not.)
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from ibr_ref import Camera, DepthImage, Light
from tests.splatting.scenes import Array, frame, looking, measured, noise, parallel, points

pytestmark = pytest.mark.usefixtures("one_thread")

vectors = st.tuples(*[st.floats(-5.0, 5.0)] * 3)
sizes = st.tuples(st.integers(1, 24), st.integers(1, 24))


def afx(size: tuple[int, int], flat: bool) -> Camera:
    """A camera with the fields of a file."""
    fov = (2.0, 1.7) if flat else (1.1, 0.7)
    return Camera.axis_angle(position=(1.0, 2.0, 3.0), orientation=(0.2, 1.0, -0.3, 2.1), field_of_view=fov,
                             orthographic=flat, near=0.5, far=20.0, width=size[0], height=size[1])  # fmt: skip


@st.composite
def cameras(draw: Any) -> Camera:
    """Of every kind, anywhere within 10 units of the origin."""
    size = draw(sizes)
    kind = draw(st.sampled_from(["perspective", "orthographic", "measured", "afx", "afx box"]))
    if kind.startswith("afx"):
        return afx(size, flat=kind == "afx box")
    eye, sight = np.array(draw(vectors)), np.array(draw(vectors))
    sight = sight if np.abs(sight[:2]).max() > 0.1 else np.array([1.0, 0.0, 0.0])
    if kind == "measured":
        return measured(eye, eye + sight, size=size, skew=draw(st.floats(-3.0, 3.0)), error=4e-4)
    return (looking if kind == "perspective" else parallel)(eye, eye + sight, size=size)


def check_is_itself(image: DepthImage) -> None:
    """Every valid pixel shows its own point, and every other one the background."""
    color, depth, mask = image.arrays
    camera = image.camera
    here = frame([image], camera)
    row, column = np.nonzero(mask)
    landed = here.stages["vertex.window"] - np.stack([column + 0.5, row + 0.5], axis=1)
    assert np.abs(landed).max() < 1e-9, "the precondition is 1/512"
    own = np.full(mask.shape, -1)
    own[mask] = np.arange(mask.sum())
    assert_array_equal(here.stages["raster.splat"], own)
    assert_array_equal(here.stages["raster.overdraw"], mask)
    assert_array_equal(here.color, np.where(mask[..., None], color, (0.1, 0.2, 0.3)))
    near, far, z = camera.near, camera.far, np.where(mask, depth, 1.0)
    expected = far * (z - near) / ((far - near) * z) if camera.perspective else (z - near) / (far - near)
    np.testing.assert_allclose(here.depth, np.where(mask, expected, 1.0), rtol=0, atol=1e-12)


@settings(derandomize=True, deadline=None, max_examples=150)
@given(cameras(), st.integers(0, 999), st.sampled_from([0.0, 0.3, 0.9]))
def test_a_reference_from_its_own_camera_is_itself(camera: Camera, seed: int, holes: float) -> None:
    """Depths anywhere between the planes, and holes in the mask."""
    shape = (camera.height, camera.width)
    depth = camera.near + (0.001 + 0.998 * noise(*shape, seed=seed)) * (camera.far - camera.near)
    mask = noise(*shape, seed=seed + 1) >= holes
    mask[0, 0] = True
    check_is_itself(DepthImage(color=noise(*shape, 3), depth=depth, camera=camera, mask=mask))


def test_the_transpose_of_a_measured_rotation_would_not_do() -> None:
    """What the inverse is for: the transpose is off by more than the 1/512 pixel that the identity leaves."""
    camera = measured((1, 2, 3), error=4e-4)
    image = DepthImage(color=noise(24, 32, 3), depth=np.full((24, 32), 5.0), camera=camera)
    view = camera.view_from_world
    p_view = points(image) @ view[:3, :3].T + view[:3, 3]
    wrong = (p_view - view[:3, 3]) @ view[:3, :3]
    again = wrong @ view[:3, :3].T + view[:3, 3]
    off: Array = (again[..., :2] / -again[..., 2:] - p_view[..., :2] / -p_view[..., 2:]) * camera.intrinsics[0, 0]
    assert np.abs(off).max() > 1 / 512
    check_is_itself(image)


def test_a_light_changes_the_colours_alone() -> None:
    image = DepthImage(color=noise(24, 32, 3), depth=3 + noise(24, 32), camera=looking((1, 2, 3)))
    dark, lit = frame([image], image.camera), frame([image], image.camera, Light(direction=(1, 2, 3)))
    for name, array in dark.stages.items():
        if name != "vertex.color":
            for one, other in zip(
                *(a if isinstance(a, tuple) else (a,) for a in (array, lit.stages[name])), strict=True
            ):
                assert_array_equal(one, other, err_msg=name)
    assert (dark.color != lit.color).any()
