"""Elliptical weighted averages against their definition: the projected Gaussian, and a plain loop over pixels and splats."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from ibr_ref import Camera, DepthImage, Light, splatting
from ibr_ref.io import Frame
from ibr_ref.models.surface_depths import ball_depths, dots, plane_depths
from ibr_ref.pipeline.ellipses import MOST_CUTOFF, gaussian
from ibr_ref.splatting import Params, Scene
from ibr_ref.splatting.footprint import LEAST_COSINE
from tests.splatting.scenes import Array, frame, image_of, looking, measured, parallel

pytestmark = pytest.mark.usefixtures("one_thread")

BACKGROUND = (0.1, 0.2, 0.3)  # of `frame`
LAMP = Light(position=(0.5, -4.0, 2.0), ambient=0.1, diffuse=0.5, specular=0.3, exponent=9)


def ball(camera: Camera) -> DepthImage:
    return image_of(camera, ball_depths(camera))


def test_the_gaussian_is_the_exponential() -> None:
    for q in np.linspace(0.0, MOST_CUTOFF**2, 200):
        assert gaussian(q) == pytest.approx(math.exp(-q / 2.0), rel=1e-14)
    assert gaussian(0.0) == 1.0


# The footprint


def wall(size: int = 9, **reference: Any) -> DepthImage:
    """The plane y = 0, seen straight on from -y: its normals have codes of an axis, without an error."""
    camera = parallel((0, -4, 0), size=(size, size), **reference)
    return DepthImage(color=np.ones((size, size, 3)), depth=np.full((size, size), 4.0), camera=camera)


@pytest.mark.parametrize("angle", [0, 40, 75, 89])
def test_a_plane_seen_obliquely_has_the_projected_gaussian(angle: float) -> None:
    """Without perspective: k view pixels a reference pixel upwards, k cos(angle) across the axis it is turned about."""
    cosine, sine = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    view = parallel((4 * sine, -4 * cosine, 0), size=(32, 24), view_height=2.0)
    k = (2.5 / 9) * (24 / 2.0)
    found = frame([wall()], view, shape="ellipse", footprint=0.7, low_pass=0.4, cutoff=2.0)
    expected = [0.49 * (k * cosine) ** 2 + 0.16, 0.0, 0.49 * k * k + 0.16]
    assert_allclose(found.stages["vertex.covariance"], np.broadcast_to(expected, (81, 3)), rtol=1e-10, atol=1e-10)
    amplitude = 0.49 * k * k * cosine / math.sqrt(expected[0] * expected[2])
    assert_allclose(found.stages["vertex.amplitude"], amplitude, rtol=1e-10)
    assert_allclose(found.stages["vertex.width"], 4.0 * math.sqrt(expected[2]), rtol=1e-12)


VIEWS = {"perspective": looking((1.0, -3.0, 1.0)), "orthographic": parallel((1.0, -3.0, 1.0)),
         "measured": measured((1.0, -3.0, 1.0))}  # fmt: skip
REFERENCES = {"perspective": looking((0.4, -3.5, 1.2)), "orthographic": parallel((0.4, -3.5, 1.2)),
              "measured": measured((0.4, -3.5, 1.2))}  # fmt: skip


def line_of_sight(camera: Camera, column: float, row: float) -> tuple[Array, Array]:
    """Where the line of sight through a window position has depth 0, and its way for a depth of 1."""
    (f_x, skew, center_x), (_, f_y, center_y), _ = camera.intrinsics
    y = (row - center_y) / f_y
    x = (column - center_x - skew * y) / f_x
    m = camera.world_from_view
    if camera.perspective:
        return m[:3, 3], m[:3, :3] @ (x, -y, -1.0)
    return m[:3, :3] @ (x, -y, 0.0) + m[:3, 3], m[:3, :3] @ (0.0, 0.0, -1.0)


def window(camera: Camera, p: Array) -> Array:
    x, y, _, w = camera.clip_from_view @ camera.view_from_world @ np.append(p, 1.0)
    return np.array([(x / w + 1) / 2 * camera.width, (1 - y / w) / 2 * camera.height])


def jacobian(reference: Camera, view: Camera, normal: Array, row: int, column: int, depth: float) -> Array:
    """By central differences of what the tangent plane makes of the reference's pixels in the view."""
    start, way = line_of_sight(reference, column + 0.5, row + 0.5)
    p, h = start + way * depth, 1e-4
    columns = []
    for du, dv in ((h, 0.0), (0.0, h)):
        ends = []
        for sign in (1, -1):
            at, along = line_of_sight(reference, column + 0.5 + sign * du, row + 0.5 + sign * dv)
            ends.append(window(view, at + along * ((p - at) @ normal / (along @ normal))))
        columns.append((ends[0] - ends[1]) / (2 * h))
    return np.array(columns).T


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("reference", REFERENCES)
def test_the_covariance_is_that_of_the_map_between_the_images(reference: str, view: str) -> None:
    camera = REFERENCES[reference]
    stages = frame([ball(camera)], VIEWS[view], shape="ellipse", footprint=0.6, low_pass=0.3, max_width=500).stages
    codes = stages["atlas.normal"][0].astype(float)
    compared = 0
    for i in range(0, len(stages["vertex.depth"]), 7):
        _, row, column = stages["vertex.source"][i]
        normal = (codes[row, column] - 128.0) / 127.0
        normal /= math.sqrt(dots(normal, normal))
        _, way = line_of_sight(camera, column + 0.5, row + 0.5)
        if math.isnan(stages["vertex.depth"][i]) or way @ normal > -1.01 * LEAST_COSINE * math.sqrt(way @ way):
            continue
        depth = float(stages["atlas.depth"][0][row, column])
        j = jacobian(camera, VIEWS[view], normal, row, column, depth)
        c = 0.36 * j @ j.T + 0.09 * np.eye(2)
        assert_allclose(stages["vertex.covariance"][i], [c[0, 0], c[0, 1], c[1, 1]], rtol=1e-5, atol=1e-6)
        amplitude = 0.36 * abs(np.linalg.det(j)) / math.sqrt(np.linalg.det(c))
        assert stages["vertex.amplitude"][i] == pytest.approx(amplitude, rel=1e-5)
        compared += 1
    assert compared > 10


def test_a_grazing_plane_stretches_no_further() -> None:
    """A plane that the reference sees at 80 degrees, so close that it is no jump, drawn from the side."""
    camera, angle = parallel((0, -4, 0), size=(9, 9), view_height=0.1), math.radians(80)
    depth = plane_depths(camera, (math.sin(angle), -math.cos(angle), 0.0), 0.0)
    view = parallel((-4, 0, 0), size=(9, 9), view_height=0.1)
    found = frame([image_of(camera, depth)], view, shape="ellipse", footprint=1.0, low_pass=0.1, max_width=500).stages
    step = math.sqrt(found["vertex.covariance"][40, 0] - 0.01)  # in depth, for a pixel's step to the side
    assert step == pytest.approx(math.sin(angle) / LEAST_COSINE, rel=0.01)  # 8-bit normals
    assert step < 0.5 * math.tan(angle)


def test_no_ellipse_is_wider_than_allowed() -> None:
    """An eye among the points: the footprint shrinks, the filter stays, and nothing is undefined."""
    view = looking((0.0, -1.02, 0.0), (0.3, 5.0, 0.0), near=1e-3)
    found = frame([ball(REFERENCES["perspective"])], view, shape="ellipse", max_width=12.0)
    kept = found.stages["vertex.width"] > 0.0
    assert found.stages["vertex.width"].max() == pytest.approx(12.0, rel=1e-12)
    xx, xy, yy = found.stages["vertex.covariance"][kept].T
    assert (xx * yy - xy * xy >= 0.25**2 * (1 - 1e-9)).all()
    assert np.isfinite(found.color).all()
    assert np.isnan(found.stages["vertex.covariance"][~kept]).all()


# The average


def one_splat(**params: Any) -> Frame:
    """A single point in the middle of a view that is turned against it, covariance and all."""
    reference = Camera.orthographic(eye=(0, -4, 0), target=(0, 0, 0), view_height=2.0, near=1, far=9, width=1, height=1)
    image = DepthImage(color=[[[1.0, 0.5, 0.25]]], depth=[[4.0]], camera=reference)
    view = parallel((2.0, -3.0, 1.0), size=(64, 64), view_height=16.0, up=(0.3, 0.0, 1.0))
    return frame([image], view, shape="ellipse", footprint=0.5, low_pass=1.5, **params)


def test_the_weights_of_a_splat_have_its_covariance() -> None:
    """Their moments over the pixels, which sample a Gaussian this wide without an error, out to six deviations."""
    found = one_splat(cutoff=6.0).stages
    (xx, xy, yy), weight = found["vertex.covariance"][0], found["raster.weight"]
    assert abs(xy) > 0.1
    assert abs(xx - yy) > 0.5
    y, x = np.mgrid[:64, :64] + 0.5
    x, y = x - 32.0, y - 32.0
    total = 2.0 * math.pi * math.sqrt(xx * yy - xy * xy) * found["vertex.amplitude"][0]
    assert weight.sum() == pytest.approx(total, rel=1e-6)
    moments = [(weight * a).sum() / weight.sum() for a in (x * x, x * y, y * y)]
    assert_allclose(moments, [xx, xy, yy], rtol=1e-5)


def test_a_splat_covers_its_ellipse() -> None:
    found = one_splat(cutoff=2.0).stages
    xx, xy, yy = found["vertex.covariance"][0]
    y, x = np.mgrid[:64, :64] + 0.5 - 32.0
    q = (yy * x * x - 2 * xy * x * y + xx * y * y) / (xx * yy - xy * xy)
    assert np.abs(q - 4.0).min() > 1e-6, "a pixel on the border"
    assert_array_equal(found["raster.splat"] == 0, q < 4.0)
    assert_array_equal(found["raster.overdraw"], (q < 4.0).astype(int))


def snapped(x: float) -> float:
    return round(256.0 * x) / 256.0


def plain(found: dict[str, Any], height: int, width: int, cutoff: float, tolerance: float) -> dict[str, Array]:
    """All splats at every pixel, one after the other, from what the vertex stage says of them."""
    out = {"weight": np.zeros((height, width)), "color": np.tile(np.array(BACKGROUND), (height, width, 1)),
           "splat": np.full((height, width), -1), "blended": np.zeros((height, width), int)}  # fmt: skip
    for row in range(height):
        for column in range(width):
            covering = []
            for i, (x, y) in enumerate(found["vertex.window"]):
                if math.isnan(x):
                    continue
                dx, dy = column + 0.5 - snapped(x), row + 0.5 - snapped(y)
                xx, xy, yy = found["vertex.covariance"][i]
                q = (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy)
                if q <= cutoff * cutoff:
                    covering.append((found["vertex.depth"][i], i, q))
            if not covering:
                continue
            nearest = min(covering)[1]
            most = found["vertex.distance"][nearest] * (1 + tolerance)
            shown = [(i, q) for _, i, q in covering if found["vertex.distance"][i] <= most]
            weights = [found["vertex.amplitude"][i] * math.exp(-q / 2) for i, q in shown]
            share = np.array(weights) / sum(weights)
            assert share.sum() == pytest.approx(1.0, abs=1e-14)
            out["weight"][row, column], out["splat"][row, column] = sum(weights), nearest
            out["blended"][row, column] = len(shown)
            out["color"][row, column] = sum(
                s * found["vertex.color"][i] for s, (i, _) in zip(share, shown, strict=True)
            )
    return out


@pytest.mark.parametrize("view", VIEWS)
def test_the_picture_is_that_of_a_plain_loop(view: str) -> None:
    """Two images of a ball, lit, before a wall."""
    cameras = [looking((0.4, -3.5, 1.2), size=(10, 8)), measured((1.5, -3.0, 0.2), size=(9, 9))]
    images = [image_of(c, np.fmin(ball_depths(c), plane_depths(c, (0, 1, 0), 2.0))) for c in cameras]
    camera = {"perspective": looking, "orthographic": parallel, "measured": measured}[view]((1, -3, 1), size=(20, 16))
    found = frame(images, camera, LAMP, shape="ellipse", footprint=0.55, cutoff=1.8, depth_tolerance=0.05)
    expected = plain(found.stages, 16, 20, 1.8, 0.05)
    assert_array_equal(found.stages["raster.splat"], expected["splat"])
    assert_array_equal(found.stages["raster.blended"], expected["blended"])
    assert_allclose(found.stages["raster.weight"], expected["weight"], rtol=1e-12)
    assert_allclose(found.color, expected["color"], rtol=1e-12)
    assert (found.stages["raster.blended"] > 1).any()
    assert (found.stages["raster.blended"] < found.stages["raster.overdraw"]).any(), "nothing lies behind"


def test_a_surface_of_one_colour_keeps_it() -> None:
    """The weights sum to 1."""
    image = DepthImage(color=np.full((9, 9, 3), (0.2, 0.7, 0.9)), depth=np.full((9, 9), 4.0), camera=wall().camera)
    found = frame([image], looking((1.0, -3.0, 1.0)), shape="ellipse")
    covered = found.stages["raster.splat"] >= 0
    assert covered.sum() > 100
    assert_allclose(found.color[covered], np.broadcast_to((0.2, 0.7, 0.9), (covered.sum(), 3)), rtol=1e-14)
    assert_array_equal(found.color[~covered], np.broadcast_to(BACKGROUND, ((~covered).sum(), 3)))


@pytest.mark.parametrize(("tolerance", "blended"), [(0.0, 1), (0.24, 1), (0.26, 2), (1.0, 2)])
def test_what_lies_behind_the_tolerance_is_hidden(tolerance: float, blended: int) -> None:
    """Two walls at the distances 4 and 5, one pixel each, the nearer black and the farther white."""
    camera = parallel((0, -4, 0), size=(1, 1))
    near, far = (DepthImage(color=np.full((1, 1, 3), c), depth=[[d]], camera=camera) for c, d in ((0, 4.0), (1, 5.0)))
    for images in ([near, far], [far, near]):
        found = frame(images, camera, shape="ellipse", depth_tolerance=tolerance)
        assert found.stages["raster.blended"].tolist() == [[blended]]
        assert found.stages["raster.overdraw"].tolist() == [[2]]
        assert_allclose(found.color, (blended - 1) / 2, atol=1e-15)


# Frames


@pytest.mark.parametrize("light", [None, LAMP])
def test_batches_and_stages_change_no_bit(light: Light | None, monkeypatch: pytest.MonkeyPatch) -> None:
    images = [ball(looking((0.4, -3.5, 1.2))), ball(looking((2.0, -2.0, 1.0), size=(17, 11)))]
    scene = Scene(images=images, camera=VIEWS["perspective"], light=light)
    params = Params(shape="ellipse")
    whole = splatting.render(scene, params)
    assert splatting.render(scene, params, stages=False).stages == {}
    for points in (1 << 17, 33, 100):
        monkeypatch.setattr("ibr_ref.splatting.batches.BATCH_POINTS", points)
        for stages in (True, False):
            again = splatting.render(scene, params, stages=stages)
            assert_array_equal(again.color, whole.color)
            assert_array_equal(again.depth, whole.depth)


def test_the_law_is_not_asked_for() -> None:
    """A law that is unsound everywhere draws the same ellipses."""
    images, view = [ball(REFERENCES["perspective"])], VIEWS["perspective"]
    assert_array_equal(
        frame(images, view, shape="ellipse", delta=-1.0).color, frame(images, view, shape="ellipse").color
    )


def test_a_view_past_the_points_is_background() -> None:
    found = frame([ball(REFERENCES["perspective"])], looking((0, -3, 0), (0, -9, 0)), LAMP, shape="ellipse")
    assert_array_equal(found.color, np.broadcast_to(BACKGROUND, found.color.shape))
    assert (found.stages["raster.weight"] == 0.0).all()
    assert (found.stages["raster.splat"] == -1).all()
