"""The third paper's steps, small: what they write, and that what they measure can fail."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import imageio.v3 as imageio
import numpy as np
import pytest

from ibr_ref import models
from ibr_ref.bench import shadows as bench
from ibr_ref.reproduce.findings import Found, Within
from ibr_ref.reproduce.shadows import REPRODUCTION, figures, quality, times
from tests.shadows.scenes import box


class Told:
    """What a step says of how far it is."""

    def __init__(self) -> None:
        self.said: list[tuple[str, int, int]] = []

    def __call__(self, description: str, done: int, total: int) -> None:
        self.said.append((description, done, total))


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two sizes, one call, a cube and a knot for all objects."""
    cube, knot = box(), models.knot(12, 6)
    monkeypatch.setattr(bench, "SIZES", (16, 32))
    monkeypatch.setattr(bench, "objects", lambda: {"kettle": cube, "chair": cube, "horse": knot})
    monkeypatch.setattr(times, "REPEAT", 1)
    for module in (quality, figures):
        monkeypatch.setattr(module, "objects", lambda: {"kettle": cube, "chair": knot, "horse": cube})
        monkeypatch.setattr(module, "which", lambda: "Triangles.")
    for name, value in (("SIZE", 32), ("OFFSETS", 2), ("SOFT_OFFSETS", 1), ("PICTURE", {"width": 32, "height": 24})):
        monkeypatch.setattr(quality, name, value)


def ran(step: Callable[[Path, Within], Found], folder: Path) -> Found:
    told = Told()
    found = step(folder, told)
    assert told.said
    assert all(0 <= done < total for _, done, total in told.said)
    for table in found.tables:
        assert table.how
        assert all(len(row) == len(table.columns) for row in table.rows)
    for claim in found.claims:
        assert claim.published
        assert claim.measured
    return found


def test_steps_have_names_of_their_own_and_tables_and_figures_are_all_there() -> None:
    names = [step.name for step in REPRODUCTION.steps]
    assert len(set(names)) == len(names)
    assert {"table-1", "tables-2-3-5", "table-4", "figure-4", "figure-7", "figure-8", "figures-9-12"} <= set(names)


@pytest.mark.long
def test_times_stand_beside_the_papers(tmp_path: Path) -> None:
    one = ran(times.table_1, tmp_path).tables[0]
    assert [row[:3] for row in one.rows][:2] == [("kettle", 12, "16²"), ("kettle", 12, "32²")]
    assert one.rows[0][4] == 4  # the paper's first time of all
    two, three, five, frames = ran(times.by_samples, tmp_path).tables
    assert [len(table.rows) for table in (two, three, five, frames)] == [2, 6, 4, 4]
    assert frames.rows[0][2] is None  # the paper has none
    assert two.rows[0][2] == 22
    assert five.rows[3][0] == "warped, 9 samples"
    assert five.rows[3][2] == 33


def test_memory_is_that_of_the_arrays(tmp_path: Path) -> None:
    memory = ran(times.table_4, tmp_path).tables[1]
    assert memory.rows[1][1] == 1024 * 32 * 32 / 2**20
    assert memory.rows[1][4] == pytest.approx((9 * 32 * 32 + 9 * 15 * 5 * 2 * 8 + 9 * 2 * 8) / 2**20)


def test_cut_triangles_are_the_same_surface() -> None:
    cut = times._cut(box(), 2)
    corners = np.asarray(cut.vertices)[np.asarray(cut.triangles)]
    twice = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    assert len(corners) == 16 * 12
    assert np.allclose(twice, 0.8**2 / 16)
    assert np.abs(corners).max() == 0.4


def test_quality_by_hand() -> None:
    ours, theirs = np.array([[0.5, 0.0, 1e-4, 0.25]]), np.array([[1.0, 0.0, 0.0, 0.0]])
    assert quality.difference(ours, theirs) == pytest.approx(0.375)
    assert quality.difference(0.0 * ours, 0.0 * ours) == 0.0
    assert quality.grey_share(np.array([[1.0, 0.5, 0.05, 0.95]])) == pytest.approx(1 / 3)


@pytest.mark.long
def test_qualities(tmp_path: Path) -> None:
    maps = ran(quality.maps_quality, tmp_path)
    values = np.array([row[1:] for row in maps.tables[0].rows], np.float64)
    assert values.shape == (7, 9)
    assert ((values >= 0.0) & (values <= 1.0)).all()
    moved = next(claim for claim in maps.claims if claim.claim.startswith("A moved light"))
    assert moved.holds
    soft = {row[0]: row for row in ran(quality.soft_quality, tmp_path).tables[0].rows}
    assert soft["grid, Haar, 9 samples"][2] is None
    assert soft["grid, raw, 9 samples"][-1] == 1.0
    assert all(0.0 < float(value or 1.0) < 1.0 for row in soft.values() for value in row[1:-1:2])


@pytest.mark.parametrize(
    ("step", "shape"),
    [(figures.figure_4, (672, 672, 3)), (figures.figure_8, (240, 976, 3)), (figures.soft_side_by_side, (488, 1632, 3))],
)
def test_figures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: Any, shape: tuple[int, ...]) -> None:
    figures._warping.cache_clear()
    monkeypatch.setattr(figures, "PLACEMENT", "bounds")
    (figure,) = ran(step, tmp_path).figures
    picture = imageio.imread(tmp_path / figure.file)
    assert picture.shape == shape
    assert (picture < 60).all(axis=-1).mean() > 0.005
    figures._warping.cache_clear()
