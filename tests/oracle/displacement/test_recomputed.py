"""The program's own values are the reference's: on the same inputs every number agrees to rounding of float64."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.device import IEEE32
from ibr_ref.oracle.referees.displacement.hits import hits_of, lighted, points_of, shades_of
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.picture import picture_of
from ibr_ref.oracle.referees.displacement.replay import Port, light_input, march_input, shade_input
from tests.oracle.displacement.drawn import SMALL, case, reference

ROUNDING = 1e-12
"""Of float64 after some hundred operations on numbers of about 1: 4,000 roundings of 2^-52."""


UNTOLD = ("relaxed_cone",)
"""Searches whose indices do not say which way they took: of a pixel's outcomes the nearest to the reference is looked at."""


def near(found: np.ndarray, expected: np.ndarray) -> bool:
    return bool((abs(found - expected) <= ROUNDING * np.maximum(1.0, abs(expected))).all())


def values(vector: list) -> np.ndarray:
    return np.stack([x.value for x in vector], axis=-1)


@pytest.fixture(params=SMALL)
def port(request: pytest.FixtureRequest) -> Port:
    return Port(model=Model(case(request.param), IEEE32), handed=reference(request.param))


@pytest.mark.sampled(4)
def test_corners(port: Port) -> None:
    legal = port.model.vertices
    for name in ("vertex.clip", "vertex.patch"):
        assert near(legal[name].value, port.handed[name])


@pytest.mark.sampled(4)
@np.errstate(all="ignore")
def test_fragments(port: Port) -> None:
    """Of every pixel that the reference covers there is the same candidate, at the same place."""
    points = points_of(port.model)
    face, polygon = port.ints("raster.face"), port.ints("raster.patch_id")
    same = (points.face == face[points.pixel]) & (points.polygon == polygon[points.pixel])
    pixel = points.pixel[same]
    assert set(pixel) == set(np.flatnonzero(face >= 0))
    close = abs(values(points.point)[same] - port.floats("raster.patch")[pixel]).max(axis=1) <= ROUNDING
    assert set(pixel[close]) == set(pixel)


@np.errstate(all="ignore")
def test_hits_shades_and_colours(port: Port) -> None:
    model = port.model
    points, _ = march_input(port, points_of(model))
    hits, lost = hits_of(model, points)
    same = np.all(
        [port.agreement(f"march.{n}", hits.pixel, getattr(hits, n)) for n in ("linear_index", "hit_index", "steep")],
        axis=0,
    )
    assert set(np.flatnonzero(port.ints("raster.face") >= 0)) - set(lost) <= set(hits.pixel[same])
    hits = hits.take(same & hits.kept)
    away = abs(values(hits.hit) - port.floats("march.hit")[hits.pixel]).max(axis=1)
    order = np.lexsort((away, hits.pixel))  # halvings leave no trace in the indices of some searches
    hits = hits.take(order[np.unique(hits.pixel[order], return_index=True)[1]]) if port.case.system in UNTOLD else hits
    assert near(values(hits.hit), port.floats("march.hit")[hits.pixel])
    before = abs(hits.height_before.value - port.floats("march.height_before")[hits.pixel]) <= ROUNDING
    assert set(hits.pixel[before]) == set(hits.pixel)
    hits = shade_input(port, hits, lambda: points)
    shades, lost = shades_of(model, hits)
    assert not len(lost)
    same = port.agreement("shade.lit", shades.pixel, shades.lit)
    # A slope at the least difference that counts: of each outcome the value is in the middle of what is decided of it.
    several = np.bincount(shades.pixel)[shades.pixel] > 1
    for name in ("albedo", "normal"):
        theirs, ours = port.floats(f"shade.{name}")[shades.pixel], getattr(shades, name)
        close = (abs(values(ours) - theirs) <= ROUNDING).all(axis=1)
        within = np.all([x.allows(theirs[:, k]) for k, x in enumerate(ours)], axis=0)
        same &= close | (several & within)
    assert set(shades.pixel[same]) == set(np.flatnonzero(port.ints("march.hit_index") >= 0))
    surfaces = light_input(port, hits, shades)
    index, color, lost = lighted(model, hits, surfaces)
    assert not len(lost)
    assert len(index) >= len(hits)
    shown = port.floats("depth") < 1.0
    pixel = surfaces.pixel[index]
    close = (abs(values(color) - port.floats("color")[pixel]) <= ROUNDING).all(axis=1)
    assert set(np.flatnonzero(shown)) <= set(pixel[close])
    deep = abs(hits.depth.value - port.floats("depth")[hits.pixel]) <= ROUNDING
    if port.case.params.depth == "displaced":
        assert set(np.flatnonzero(shown)) <= set(hits.pixel[deep])


@np.errstate(all="ignore")
def test_what_the_reference_shows_is_among_the_candidates(port: Port) -> None:
    picture = picture_of(port.case, IEEE32)
    lost = picture.fragments.pixel[picture.lost]
    shown = np.setdiff1d(np.flatnonzero(port.floats("depth") < 1.0), lost)
    looks = picture.all.take(picture.possible & (picture.all.hit_index >= 0))
    key = looks.pixel * (1 << 25) + looks.hit_index
    assert set(shown * (1 << 25) + port.ints("march.hit_index")[shown]) <= set(key)
