"""`ibr_ref.sweep.sweep`, in this process: rows, files, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as parquet
import pytest

from ibr_ref import displacement, metrics, models, shadows, splatting
from ibr_ref.scene import Light
from ibr_ref.sweep import Sweep, measures, sweep
from ibr_ref.sweep.subject import Subject
from tests.sweep.scenes import bumps, rig

OVER = {"linear_steps": [2, 8, 32], "binary_steps": [0, 6]}


def swept(**changes: Any) -> Sweep:
    values: dict[str, Any] = {"method": "displacement", "scene": bumps(), "over": OVER, "views": 3, "workers": 0}
    return sweep(**{**values, **changes})


def rows(found: Sweep) -> list[dict[str, Any]]:
    """Without the times."""
    return [{k: v for k, v in row.items() if k != "milliseconds"} for row in found.table.to_pylist()]


def test_one_row_a_setting_and_view() -> None:
    found = swept()
    keys = [(row["linear_steps"], row["binary_steps"], row["view"]) for row in rows(found)]
    assert keys == [(n, m, view) for n in (2, 8, 32) for m in (0, 6) for view in range(3)]
    assert found.table.column_names == ["linear_steps", "binary_steps", "view", *measures("displacement")]
    assert all(ms > 0 for ms in found.table.column("milliseconds").to_pylist())


def test_measures_are_what_they_say() -> None:
    """The first view is the scene's own."""
    row = rows(swept(over={"steps": [4]}, params=displacement.Params(binary_steps=2)))[0]
    frame = displacement.render(bumps(), displacement.Params(linear_steps=4, binary_steps=2))
    truth = displacement.render(bumps(), displacement.Params(method="exact", linear_steps=800))
    assert row["wrong"] == metrics.wrong(frame, truth).mean()
    shown = frame.depth < 1, truth.depth < 1
    assert row["silhouette"] == (shown[0] & shown[1]).sum() / (shown[0] | shown[1]).sum()
    assert 1 < row["fetches"] <= 7


def test_more_steps_are_less_wrong() -> None:
    found = swept(over={"linear_steps": [2, 200]})
    few, many = found.outcomes
    assert many.error < 0.3 * few.error
    assert many.cost > few.cost
    assert found.smallest(many.error) == many
    assert found.smallest(0.9 * many.error) is None
    assert found.frontier == [few, many]


def test_splatting_against_the_mesh_and_against_nothing() -> None:
    images, camera = rig()
    scene = splatting.Scene(images=images, camera=camera, light=None)
    found = sweep("splatting", scene, over={"alpha": [1.0, 3.0]}, views=2, against=models.kettle(), workers=0)
    thin, wide = rows(found)[0], rows(found)[2]
    assert thin["holes"] > wide["holes"]
    assert thin["overdraw"] < wide["overdraw"]
    frame = splatting.render(scene, splatting.Params(alpha=3.0))
    assert wide["holes"] == splatting.coverage(scene, frame).hole_share
    assert 10 < wide["decibels"] < 60
    blind = sweep("splatting", scene, over={"alpha": [1.0]}, workers=0)
    assert rows(blind)[0]["decibels"] is None
    assert blind.by(error="decibels").outcomes == []


def test_splatting_against_pictures() -> None:
    """A picture seen from where it was taken is itself."""
    images, camera = rig()
    scene = splatting.Scene(images=images, camera=camera, light=None)
    found = sweep("splatting", scene, over={"alpha": [1.0]}, views=4, against=images, workers=0)
    assert all(row["decibels"] > 25 for row in rows(found))
    with pytest.raises(ValueError, match=r"^views: found 3, allowed: 4, one for each picture"):
        sweep("splatting", scene, over={"alpha": [1.0]}, views=3, against=images, workers=0)


def test_shadows_at_places_of_the_caster() -> None:
    stage = models.shadow_stage(models.sphere(), width=48, height=36)
    small = shadows.Params(map_size=32, rows=5, columns=4)
    over = {"method": ["warp", "direct"], "controls": ["bounds"]}
    warped, direct = (rows(sweep("shadows", stage, over=over, params=small, views=3, workers=0))[i] for i in (2, 5))
    assert (direct["map"], direct["shadow"], direct["soft"], direct["bytes"]) == (1.0, 1.0, 0.0, 0.0)
    assert 0.5 < warped["map"] < 1.0
    assert warped["bytes"] == 9 * 32 * 32 + 9 * 5 * 4 * 2 * 8 + 9 * 2 * 8


# --- Files -----------------------------------------------------------------------------------------------------------


def test_a_file_is_gone_on_from(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "sweep.parquet"
    part = swept(over={"linear_steps": [2, 8], "binary_steps": [0]}, out=out)
    done: list[tuple[str, int, int]] = []
    whole = swept(out=out, progress=lambda *said: done.append(said))
    assert done[0] == ("rows", 9, 18), "6 rows were there"
    assert done[-1] == ("rows", 18, 18)
    assert rows(whole) == rows(swept())
    assert set(parquet.read_table(out).column_names) == set(whole.table.column_names)
    kept = {tuple(row.values()) for row in part.table.to_pylist()}
    assert kept <= {tuple(row.values()) for row in whole.table.to_pylist()}, (
        "with their times: they were not made again"
    )
    again = swept(out=out, progress=lambda *_: pytest.fail("nothing is missing"))
    assert again.table.equals(whole.table)


def test_an_interrupted_sweep_keeps_what_it_has(tmp_path: Path) -> None:
    out = tmp_path / "sweep.parquet"

    def interrupt(_: str, done: int, total: int) -> None:
        if done > total // 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        swept(out=out, progress=interrupt)
    assert 9 < len(parquet.read_table(out)) < 18
    assert rows(swept(out=out)) == rows(swept())


def test_other_sweeps_files_are_left_alone(tmp_path: Path) -> None:
    out = tmp_path / "sweep.parquet"
    swept(over={"linear_steps": [2]}, out=out)
    before = out.read_bytes()
    for changes in (
        {"scene": bumps(seed=1)},
        {"views": 2},
        {"params": displacement.Params(shadow_steps=3)},
        {"over": {"linear_steps": [2], "faces": ["base"]}},
    ):
        with pytest.raises(ValueError, match=r"sweep.parquet: found a sweep of another scene"):
            swept(**{"over": {"linear_steps": [2]}, "out": out, **changes})
    for content in (b"no table", b"PAR1PAR1"):
        (tmp_path / "bad.parquet").write_bytes(content)
        with pytest.raises(ValueError, match=r"^.*bad\.parquet: "):
            swept(out=tmp_path / "bad.parquet")
    assert out.read_bytes() == before


def test_a_scene_made_again_has_the_same_digest() -> None:
    def digest(**changes: Any) -> str:
        return Subject("displacement", [replace(bumps(), **changes)], "exact").digest

    assert digest() == digest()
    assert digest() != digest(background=(0.0, 0.0, 0.1))


def test_a_subject_arrives_as_it_was() -> None:
    """Its arrays are as writable as before: kernels are compiled for either kind."""
    subject = Subject("displacement", [bumps(), bumps(seed=1)], "exact")
    there = Subject.unpacked(subject.packed())
    assert there.digest == subject.digest
    for scene in there.views:
        assert not scene.polygons[0].height_map.flags.writeable
        assert not scene.camera.view_from_world.flags.writeable
    assert np.array_equal(displacement.render(there.views[1]).color, displacement.render(bumps(seed=1)).color)


# --- Results ---------------------------------------------------------------------------------------------------------


def test_the_frontier_is_what_nothing_beats() -> None:
    found = swept(over={"linear_steps": [2, 3, 5, 8, 13, 21], "binary_steps": [0, 1, 3, 6]}, views=2)
    outcomes = found.outcomes
    assert len(outcomes) == 24
    for one in outcomes:
        beaten = any(
            other.error <= one.error and other.cost <= one.cost and (other.error, other.cost) != (one.error, one.cost)
            for other in outcomes
        )
        twin = any((o.error, o.cost) == (one.error, one.cost) and o is not one for o in outcomes)
        assert (one in found.frontier) != beaten or twin
    for bound in (0.5, 0.1, 0.03, 0.0):
        good = [o for o in outcomes if o.error <= bound]
        chosen = found.smallest(bound)
        assert (chosen is None) == (not good)
        if chosen is not None:
            assert chosen.cost == min(o.cost for o in good)


def test_the_worst_view_counts() -> None:
    found = swept(over={"linear_steps": [4]})
    errors, costs = (found.table.column(name).to_pylist() for name in ("wrong", "fetches"))
    (outcome,) = found.outcomes
    assert (outcome.error, outcome.cost) == (max(errors), pytest.approx(np.mean(costs)))
    assert found.by(error="silhouette").outcomes[0].error == min(found.table.column("silhouette").to_pylist())


def test_the_plot(tmp_path: Path) -> None:
    found = swept()
    figure = found.plot(tmp_path / "plot.png", bound=0.2)
    (axes,) = figure.axes
    assert "fetches" in axes.get_xlabel()
    assert "wrong <= 0.2" in [text.get_text() for text in axes.get_legend().get_texts()]
    assert (tmp_path / "plot.png").stat().st_size > 10_000


# --- Bad input -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"method": "magic"}, "method: found 'magic', allowed: displacement"),
        ({"over": {}}, "over: found 'nothing'"),
        ({"over": {"stepps": [1]}}, "over: found 'stepps', allowed: fields of Params: linear_steps"),
        ({"over": {"linear_steps": []}}, r"over\['linear_steps'\]: found \[\]"),
        ({"over": {"linear_steps": "12"}}, r"over\['linear_steps'\]: found '12'"),
        ({"over": {"linear_steps": [1, 1]}}, r"over\['linear_steps'\]: found \[1, 1\], allowed: each value once"),
        ({"over": {"linear_steps": [None]}}, r"over\['linear_steps'\]: found \[None\], allowed: numbers"),
        ({"over": {"linear_steps": [5, 0]}}, "linear_steps=0: linear_steps: found 0"),
        (
            {"over": {"linear_steps": list(range(1, 2000)), "binary_steps": [0]}, "views": 4096},
            "over: found '8187904 rows",
        ),
        ({"views": 0}, "views: found 0, allowed: a whole number from 1 to 4096"),
        ({"against": "rays"}, "against: found 'rays', allowed: exact"),
        ({"params": shadows.Params()}, "params: found 'Params', allowed: the method's Params"),
    ],
    ids=str,
)
def test_bad_input_is_named(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=f"^{words}"):
        swept(**changes)


def test_what_fails_on_the_way_names_its_setting() -> None:
    images, camera = rig()
    scene = splatting.Scene(images=images, camera=camera, light=None)
    with pytest.raises(ValueError, match=r"^delta=-5: beta, gamma, delta: found"):
        sweep("splatting", scene, over={"delta": [1, -5]}, workers=0)
    lit = replace(scene, light=Light(direction=(0, 0, 1)))
    with pytest.raises(ValueError, match=r"^against: found 'Mesh', allowed: None with a light"):
        sweep("splatting", lit, over={"delta": [1]}, against=models.kettle(), workers=0)
