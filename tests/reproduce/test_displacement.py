"""The first paper's reproduction: its measures where the answer is known, its steps on small pictures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ibr_ref import io, models
from ibr_ref.displacement import Params, Scene, render
from ibr_ref.displacement import measures as measure
from ibr_ref.displacement.inputs import METHODS
from ibr_ref.reproduce.displacement import REPRODUCTION, figures_3_and_6, table_1
from ibr_ref.reproduce.displacement.scenes import looking_at, spikes
from ibr_ref.reproduce.displacement.systems import SYSTEMS
from ibr_ref.reproduce.findings import Found
from ibr_ref.scene import BasePolygon

SMALL = (96, 72)


def within(description: str, done: int, total: int) -> None:
    assert 0 <= done < total, description


@pytest.fixture(scope="module")
def box() -> Scene:
    return looking_at(models.box(), (0.65, -1.2, 0.75), size=SMALL)


def test_every_method_is_tried() -> None:
    assert {system.params.method for system in SYSTEMS} == set(METHODS) - {"exact"}


def test_an_exact_search_is_perfect(box: Scene) -> None:
    exact = render(box, Params(method="exact"))
    raised = measure.raised(box, exact)
    assert raised.sum() > 200
    assert measure.right_texels(box, exact, exact, raised) == 1.0
    assert measure.distances(box, exact, exact) == (0.0, 0.0)
    assert measure.overlap(raised, raised) == 1.0
    assert measure.drift(box, exact)[1] < 0.01


def test_drift_is_how_far_depth_moves_the_ground(box: Scene) -> None:
    """The ground sunk by s lies where the camera sees it; its texels belong s higher: one projection less the other."""
    relief = render(box, Params(method="relief", linear_steps=200))
    ground = measure.heights_at(box, relief, radius=2) == 0.0
    sunk = measure.window(box, measure.world(box, relief.stages["march.hit"]))[ground]
    raised = relief.stages["march.hit"] * (1, 1, 0)
    true = measure.window(box, measure.world(box, raised))[ground]
    assert measure.drift(box, relief)[0] == pytest.approx(np.linalg.norm(sunk - true, axis=-1).mean(), rel=1e-3)


def test_window_positions_are_the_pixels_of_the_points_seen(box: Scene) -> None:
    texture = render(box, Params(method="texture"))
    seen = np.isfinite(texture.stages["march.hit"][..., 0])
    where = measure.window(box, measure.world(box, texture.stages["march.hit"]))[seen]
    row, column = np.nonzero(seen)
    assert np.abs(where - np.stack([column + 0.5, row + 0.5], axis=-1)).max() < 0.01


def test_walls_are_the_sides_of_the_box(box: Scene) -> None:
    """Seen from the front right: two sides, both below the top; where smear is almost total without a facade."""
    exact = render(box, Params(method="exact"))
    wall = measure.walls(box, exact)
    hit = exact.stages["march.hit"][wall]
    assert wall.sum() > 100
    sides = np.array([80, 176]) / 256
    assert (np.abs(hit[:, :2, None] - sides).min(axis=(1, 2)) < 1 / 256).all()


@pytest.mark.parametrize(("method", "expected"), [("texture", 0.0), ("welsh", 1.0)])
def test_fetches_of_systems_that_never_search(box: Scene, method: str, expected: float) -> None:
    system = next(system for system in SYSTEMS if system.params.method == method)
    assert measure.fetches(system.params, render(box, system.params)) == expected


def test_fetches_of_a_search_that_finds_nothing_are_all_its_steps() -> None:
    flat = looking_at(BasePolygon(
        corner=(-0.5, -0.5, 0), edge_u=(1, 0, 0), edge_v=(0, 1, 0), height_scale=0.2,
        height_map=np.zeros((4, 4)), color_map=np.ones((2, 2, 3)),
    ), (0.65, -1.2, 0.75), size=SMALL)  # fmt: skip
    system = next(system for system in SYSTEMS if system.name == "protruded, N = 10")
    assert measure.fetches(system.params, render(flat, system.params)) == 11.0


def test_spikes_are_narrow_and_tall() -> None:
    heights = np.asarray(spikes().height_map)
    assert (heights[heights > 0] >= 0.5).all()
    assert 0.005 < (heights > 0).mean() < 0.02


@pytest.mark.parametrize("step", [figures_3_and_6.figure_3, figures_3_and_6.figure_6])
def test_figures_come_with_claims_that_hold(tmp_path: Path, step: type) -> None:
    found: Found = step(tmp_path, within, (192, 144))
    for figure in found.figures:
        assert io.read_image(tmp_path / figure.file).std() > 0.05
    assert [claim.claim for claim in found.claims if not claim.holds] == []


def test_the_table_has_a_row_for_each_system(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On the box alone, without relaxed cones, whose map takes long."""
    box = looking_at(models.box(), (0.65, -1.2, 0.75), size=SMALL)
    few = tuple(system for system in SYSTEMS if system.params.method != "relaxed_cone")
    monkeypatch.setattr(table_1, "SYSTEMS", few)
    monkeypatch.setattr(table_1, "trials", lambda size: {"box": box})
    monkeypatch.setattr(table_1, "_claims", lambda hits: ())
    (table,) = table_1.run(tmp_path, within).tables
    hits = {str(row[0]): row[2] for row in table.rows}
    assert list(hits) == [system.name for system in few]
    assert hits["maximum mipmap, Tevs 2008, Drobot 2009"] == 1.0
    assert float(hits["protruded, N = 50"] or 0) > 0.95


def test_steps_have_names_of_their_own() -> None:
    assert len({step.name for step in REPRODUCTION.steps}) == len(REPRODUCTION.steps) == 8
