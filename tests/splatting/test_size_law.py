"""The fit of the law: a known one comes back, tau of the points are wide enough, the same law every time."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ibr_ref import DepthImage, models, splatting
from ibr_ref.models.surface_depths import ball_depths, plane_depths
from ibr_ref.splatting.references import prepare, view_of
from ibr_ref.splatting.size_law import GRAZING, MOST_SAMPLES, SplatLaw, fit, needed_widths
from tests.splatting.scenes import Array, image_of, looking, noise, parallel, points

pytestmark = pytest.mark.usefixtures("one_thread")

LAWS = [(0.02, 0.1, 0.05), (0.0, 0.2, 0.0), (0.05, 0.0, 0.0), (0.0, 0.0, 0.3), (0.01, 0.0, 0.2), (1e-6, 1e-4, 1e-3)]
derandomized = settings(derandomize=True, deadline=None, max_examples=25)


def distances(count: int, seed: int, low: float = 2.0, high: float = 9.0) -> Array:
    return low + (high - low) * noise(count, seed=seed)


@pytest.mark.parametrize("coefficients", LAWS)
@pytest.mark.parametrize("tau", [0.5, 0.9, 0.95])
def test_a_known_law_comes_back(coefficients: tuple[float, float, float], tau: float) -> None:
    """Widths without noise: to the tolerance of the linear programme, 1e-7 of the inverse widths."""
    law = SplatLaw(1.0, *coefficients)
    d = distances(500, 1)
    found = fit(d, law.width(d), tau, 1e-3, 1e6)
    assert found.alpha == 1.0
    scale = float(law.width(d).max())
    np.testing.assert_allclose(1.0 / found.width(d), 1.0 / law.width(d), rtol=0, atol=max(1e-6 / scale, 1e-6))


def check_share(law: SplatLaw, d: Array, widths: Array, tau: float) -> None:
    """At the optimum no coefficient that is not 0 can be moved with gain, to either side: counted with the weights
    d^2, d or 1 that it has, tau of the points are wide enough with those that the law just touches, and no more without.
    """
    wide = law.width(d)
    for power, coefficient in enumerate((law.delta, law.gamma, law.beta)):
        if coefficient > 1e-9:
            weight = d**power
            assert weight[widths <= wide * (1 + 1e-6)].sum() >= tau * weight.sum() * (1 - 1e-9)
            assert weight[widths < wide * (1 - 1e-6)].sum() <= tau * weight.sum() * (1 + 1e-9)


@derandomized
@given(st.sampled_from(LAWS[:3]), st.floats(0.1, 0.95), st.integers(0, 999))
def test_tau_of_the_points_are_wide_enough(coefficients: tuple[float, float, float], tau: float, seed: int) -> None:
    d = distances(400, seed)
    widths = SplatLaw(1.0, *coefficients).width(d) * (0.5 + noise(400, seed=seed + 1))
    check_share(fit(d, widths, tau, 1e-3, 1e6), d, widths, tau)


@derandomized
@given(st.integers(0, 999), st.floats(0.05, 0.99), st.floats(0.5, 2.0), st.floats(1.0, 60.0))
def test_a_law_is_positive_and_stays_below_the_limit(seed: int, tau: float, least: float, more: float) -> None:
    """Whatever the widths, rising with the distance as well: coefficients >= 0, 0 < W <= max_width at all distances."""
    d = distances(100, seed, 0.5, 50.0)
    widths = 100.0 * noise(100, seed=seed + 1) ** 4 * (d if seed % 2 else 1.0)
    law = fit(d, widths, tau, least, least + more)
    assert law.alpha == 1.0
    assert min(law.beta, law.gamma, law.delta) >= 0.0
    assert law.beta * d.min() ** 2 + law.gamma * d.min() + law.delta > 0.0
    assert law.width(d).max() <= (least + more) * (1 + 1e-6)


def test_needs_beyond_the_limits_count_as_the_limits() -> None:
    """A point that needs less than `min_width` has it anyway, and none gets more than `max_width`."""
    d = distances(100, 5)
    widths = 40.0 * noise(100, seed=6)
    assert fit(d, widths, 0.7, 8.0, 30.0) == fit(d, np.clip(widths, 8.0, 30.0), 0.7, 8.0, 30.0)
    assert fit(d, widths, 0.7, 8.0, 30.0) != fit(d, widths, 0.7, 1e-3, 1e3)


def test_no_law_is_wider_than_the_limit_where_nobody_needs_it() -> None:
    """One point at d = 2 needs the most: falling with d^2, as the far point would have it, were 120 at d = 1."""
    d = np.array([1.0, 2.0, 3.0])
    law = fit(d, np.array([1.0, 30.0, 1.0]), 1.0, 0.5, 30.0)
    np.testing.assert_allclose(law.width(d), 30.0, rtol=1e-6)


def test_a_larger_tau_makes_no_narrower_splats_on_average() -> None:
    d = distances(400, 3)
    widths = SplatLaw(1.0, *LAWS[0]).width(d) * (0.5 + noise(400, seed=4))
    means = [fit(d, widths, tau, 1e-3, 1e6).width(d).mean() for tau in (0.1, 0.5, 0.8, 0.95, 1.0)]
    assert (np.diff(means) > 0.0).all()


def test_tau_1_is_wide_enough_for_all() -> None:
    d = distances(400, 3)
    widths = SplatLaw(1.0, *LAWS[0]).width(d) * (0.5 + noise(400, seed=4))
    assert (fit(d, widths, 1.0, 1e-3, 1e6).width(d) >= widths * (1 - 1e-6)).all()


# From images


def rig() -> list[DepthImage]:
    return models.depth_rig(models.sphere(segments=16), 4, size=38)


def test_the_same_images_have_the_same_law() -> None:
    """Bit for bit, from objects made anew."""
    view = looking((1.5, -2.0, 1.0), size=(64, 48))
    assert splatting.fit_splat_law(rig(), view) == splatting.fit_splat_law(rig(), view)


def test_tau_of_the_points_in_view_are_wide_enough() -> None:
    view = looking((1.5, -2.0, 1.0), size=(64, 48))
    images = rig()
    found = [needed_widths(prepare(image).reference, view_of(view), 1) for image in images]
    d, needed = (np.concatenate(arrays) for arrays in zip(*found, strict=True))
    assert 1000 < len(d) <= MOST_SAMPLES
    for tau in (0.5, 0.9, 0.95):
        law = splatting.fit_splat_law(images, view, tau=tau)
        check_share(law, d, np.clip(needed, 1.0, 64.0), tau)
        assert (needed <= law.width(d) * (1 + 1e-6)).mean() == pytest.approx(tau, abs=0.02)
        splatting.Params(**law._asdict())


def test_a_plane_seen_by_its_own_camera_needs_its_pixels() -> None:
    """Across the view each point needs exactly the side of a pixel, at any distance; with twice the resolution two."""
    for make in (looking, parallel):
        for share in (1, 2, 5):
            camera, view = make((0, -4, 0), size=(32, 24)), make((0, -4, 0), size=(32 * share, 24 * share))
            image = DepthImage(color=noise(24, 32, 3), depth=np.full((24, 32), 3.0), camera=camera)
            d, needed = needed_widths(prepare(image).reference, view_of(view), 1)
            assert len(d) == 24 * 32
            np.testing.assert_allclose(needed, share, rtol=1e-12)


def test_needed_widths_by_projection() -> None:
    """A slanted plane in another view: the larger side of the box of the quad's corners, which lie on the plane."""
    camera, view = looking((0.4, -3.5, 1.2)), looking((1.5, -2.5, 0.5), size=(64, 48))
    normal = np.array((0.2, -0.9, 0.3))
    image = image_of(camera, plane_depths(camera, normal, 0.0))
    assert np.asarray(image.mask).all()
    _, needed = needed_widths(prepare(image).reference, view_of(view), 1)
    p = points(image)
    corner = np.zeros((4, 24, 32, 2))
    across, along = np.gradient(p, axis=1) / 2.0, np.gradient(p, axis=0) / 2.0
    for i, (s, t) in enumerate([(1, 1), (1, -1), (-1, 1), (-1, -1)]):
        q = p + s * across + t * along
        v = q @ view.view_from_world[:3, :3].T + view.view_from_world[:3, 3]
        corner[i] = 48.0 / (2.0 * math.tan(math.radians(20.0))) * v[..., :2] / -v[..., 2:]
    side = (corner.max(axis=0) - corner.min(axis=0)).max(axis=2)
    window = corner.mean(axis=0) * (1, -1) + (32, 24)
    seen = ((window >= 0) & (window < (64, 48))).all(axis=2)
    assert abs(len(needed) - seen.sum()) < 10
    # Half steps of np.gradient are means of both sides: the plane is curved in depth by perspective, so 5 %.
    assert np.median(needed) == pytest.approx(np.median(side[seen]), rel=0.05)


def test_grazing_surfaces_count_with_a_limit() -> None:
    """A floor 0.2 below the eye: in a view from above its quads are up to eight times as long as wide. They count with
    GRAZING times a quad at the same place that faces both cameras.
    """
    camera = looking((0, -4, 1.0), size=(40, 120))
    depth = plane_depths(camera, (0, 0, 1), 0.8)
    image = image_of(camera, np.where(depth < 1.6, depth, np.nan))
    view = looking((0.0, -3.2, 5.0), (0.0, -3.0, 0.8), size=(64, 48))
    _, needed = needed_widths(prepare(image).reference, view_of(view), 1)
    pixel = np.nanmax(np.asarray(image.depth)) / camera.intrinsics[1, 1]
    facing = pixel * view.intrinsics[1, 1] / 4.0
    rows = np.abs(np.diff(points(image), axis=0))
    assert np.nanmax(rows) > 5.0 * pixel
    assert len(needed) > 100
    assert 0.8 * GRAZING * facing < needed.max() <= GRAZING * facing


def test_points_without_neighbours_and_out_of_view_do_not_count() -> None:
    camera = looking((0, -4, 0), size=(9, 9))
    mask = np.zeros((9, 9), bool)
    mask[::2, ::2] = True
    alone = DepthImage(color=noise(9, 9, 3), depth=np.full((9, 9), 3.0), camera=camera, mask=mask)
    assert not len(needed_widths(prepare(alone).reference, view_of(camera), 1)[0])
    whole = DepthImage(color=noise(9, 9, 3), depth=np.full((9, 9), 3.0), camera=camera)
    for view in (looking((0, -4, 0), (0, -9, 0)), looking((0, -4, 0), (9, -4, 0))):
        assert not len(needed_widths(prepare(whole).reference, view_of(view), 1)[0])
        for images in ([alone], [whole], [alone, whole]):
            with pytest.raises(ValueError, match=r"^images: found .*no point in view that has neighbours.*allowed: "):
                splatting.fit_splat_law(images, view)


@pytest.mark.parametrize("make", [looking, parallel])
def test_a_fitted_law_closes_what_one_pixel_leaves_open(make: object) -> None:
    camera = looking((0.4, -3.5, 1.2), size=(48, 36))
    image = image_of(camera, ball_depths(camera))
    view = make((0.9, -3.1, 0.8), size=(96, 72))  # type: ignore[operator]
    scene = splatting.Scene(images=[image], camera=view, light=None)
    law = splatting.fit_splat_law([image], view)
    shares = [
        splatting.coverage(scene, splatting.render(scene, params)).hole_share
        for params in (splatting.Params(), splatting.Params(**law._asdict()))
    ]
    assert shares[0] > 0.5
    assert shares[1] < 0.01
