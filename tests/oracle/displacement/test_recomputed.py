"""The referee's own values are the reference's: on the same inputs every number agrees to rounding of float64."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.device import IEEE32
from ibr_ref.oracle.referees.displacement.hits import hits_of
from ibr_ref.oracle.referees.displacement.image import candidates_of
from ibr_ref.oracle.referees.displacement.replay import Port, light_input, march_input, shade_input
from ibr_ref.oracle.referees.displacement.shown import lighted, shades_of
from tests.oracle.displacement.drawn import SMALL, case, reference

ROUNDING = 1e-12
"""Of float64 after some hundred operations on numbers of about 1: 4,000 roundings of 2^-52."""


def near(found: np.ndarray, expected: np.ndarray) -> bool:
    return bool((abs(found - expected) <= ROUNDING * np.maximum(1.0, abs(expected))).all())


@pytest.fixture(params=SMALL)
def port(request: pytest.FixtureRequest) -> Port:
    return Port(case=case(request.param), device=IEEE32, handed=reference(request.param))


def test_corners(port: Port) -> None:
    for name, field in (("vertex.clip", "clip"), ("vertex.patch", "patch")):
        ours = np.concatenate([getattr(each, field).value for each in port.candidates.faces])
        assert near(ours, port.handed[name])


def test_fragments(port: Port) -> None:
    """Of every pixel that the reference covers there is the same candidate, at the same place."""
    fragments = port.candidates.fragments
    face, polygon = port.ints("raster.face"), port.ints("raster.patch_id")
    same = (fragments.face == face[fragments.pixel]) & (fragments.polygon == polygon[fragments.pixel])
    pixel = fragments.pixel[same]
    assert set(pixel) == set(np.flatnonzero(face >= 0))
    close = abs(fragments.point.value[same] - port.floats("raster.patch")[pixel]).max(axis=1) <= ROUNDING
    assert set(pixel[close]) == set(pixel)


@np.errstate(all="ignore")
def test_hits_shades_and_colours(port: Port) -> None:
    fragments, _ = march_input(port, port.candidates.fragments)
    hits, lost = hits_of(port.constants, port.case.params, fragments)
    same = np.all(
        [port.agreement(f"march.{n}", hits.pixel, getattr(hits, n)) for n in ("linear_index", "hit_index", "steep")],
        axis=0,
    )
    assert set(np.flatnonzero(port.ints("raster.face") >= 0)) - set(lost) == set(hits.pixel[same])
    hits = hits.take(same & hits.kept)
    assert near(hits.hit.value, port.floats("march.hit")[hits.pixel])
    before = abs(hits.height_before.value - port.floats("march.height_before")[hits.pixel]) <= ROUNDING
    assert set(hits.pixel[before]) == set(hits.pixel)
    hits = shade_input(port, hits)
    shades = shades_of(port.constants, port.case.params, hits)
    pixel = hits.pixel[shades.hit]
    same = port.agreement("shade.lit", pixel, shades.lit)
    for name in ("albedo", "normal"):
        theirs = port.floats(f"shade.{name}")[pixel]
        same &= (abs(getattr(shades, name).value - theirs) <= ROUNDING).all(axis=1)
    assert set(pixel[same]) == set(np.flatnonzero(port.ints("march.hit_index") >= 0))
    index, color = lighted(port.constants, hits, light_input(port, hits, shades))
    assert len(index) >= len(hits)
    shown = port.floats("depth") < 1.0
    pixel = hits.pixel[light_input(port, hits, shades).hit[index]]
    close = (abs(color.value - port.floats("color")[pixel]) <= ROUNDING).all(axis=1)
    assert set(np.flatnonzero(shown)) <= set(pixel[close])
    deep = abs(hits.depth.value - port.floats("depth")[hits.pixel]) <= ROUNDING
    if port.case.params.depth == "displaced":
        assert set(np.flatnonzero(shown)) <= set(hits.pixel[deep])


def test_what_the_reference_shows_is_among_the_candidates(port: Port) -> None:
    found = candidates_of(port.case, port.device)
    shown = np.setdiff1d(np.flatnonzero(port.floats("depth") < 1.0), found.lost)
    winners = found.hits.take(found.possible & found.hits.kept)
    key = winners.pixel * (1 << 25) + winners.hit_index
    assert set(shown * (1 << 25) + port.ints("march.hit_index")[shown]) <= set(key)
