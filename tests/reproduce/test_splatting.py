"""The steps of the second paper on small inputs: what they measure, and what they draw."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ibr_ref import Light, models, splatting
from ibr_ref.models.surface_depths import plane_depths
from ibr_ref.reproduce.splatting import REPRODUCTION, canvas, quality, selection, speed
from ibr_ref.reproduce.splatting.systems import constant, fitted, hand_set, systems
from ibr_ref.scene import Camera
from ibr_ref.splatting import Scene
from tests.splatting.scenes import image_of, looking

pytestmark = pytest.mark.usefixtures("one_thread")

VIEW = Camera.look_at(eye=(1.9, -2.2, 1.9), target=(0.15, 0, 0.5), near=0.1, far=10, width=64, height=48)
IMAGES = models.depth_rig(models.kettle(), 4, size=32)
LIT = Scene(images=IMAGES, camera=VIEW, light=Light(direction=(-0.5, -0.8, 1.0), specular=0.3))


def silent(description: str, done: int, total: int) -> None:
    assert description
    assert 0 <= done < total


def test_every_step_has_a_name_of_its_own() -> None:
    names = [step.name for step in REPRODUCTION.steps]
    assert len(set(names)) == len(names) == 4
    assert REPRODUCTION.number == 2


def test_a_law_by_hand_closes_a_wall_that_faces_both_cameras() -> None:
    """Turned by 27 degrees, where a step of the grid needs 1.34 times its side; d grows towards the border."""
    reference, view = looking((0, -4, 0)), looking((0, -2, 0), size=(64, 48), up=(1, 0, 2))
    image = image_of(reference, plane_depths(reference, (0, 1, 0), 0.0))
    scene = Scene(images=[image], camera=view, light=None)
    frame = splatting.render(scene, hand_set([image], view))
    assert not splatting.coverage(scene, frame).holes[12:36, 16:48].any()
    assert frame.stages["vertex.width"].max() == pytest.approx(2.0**0.5 * 4.0, rel=1e-3)


def test_the_systems_do_the_same_job() -> None:
    five = {system.name: system for system in systems(LIT, fitted(IMAGES, VIEW))}
    pictures = {name: splatting.render(s.scene, s.params, stages=False).color for name, s in five.items()}
    assert len(five) == 5
    np.testing.assert_array_equal(pictures["loop in software"], pictures["law, fitted"])
    assert five["constant 2 pixels, baked light"].scene.light is None
    for color in pictures.values():
        assert np.abs(color - pictures["law, fitted"]).mean() < 0.05


def test_the_rows_of_the_tables() -> None:
    rows = [row for name in ("rig of 4", "8 references") for row in speed.timed(name, LIT, constant(1.0), 1, silent)]
    assert [row.system.paper for row in rows[:5]] == ["Shader", "", "OpenGL", "Software", ""]
    one, two = speed._tables(rows, photographed=False)
    assert len(one.rows) == len(two.rows) == 5
    points = sum(int(image.arrays[2].sum()) for image in IMAGES)
    for row, timed in zip(one.rows, rows[:5], strict=True):
        assert row[1] == points
        assert row[6] == pytest.approx(points / timed.best / 1e6)
    assert one.rows[0][7:] == (559.84, 25.19)
    assert two.rows[3][7:] == (0.12, 0.77)
    assert one.rows[1][7:] == (None, None)
    software, opengl, _ = speed._claims(rows)
    assert software.holds == (rows[3].best / rows[0].best + rows[8].best / rows[5].best >= 4.0)
    assert opengl.claim.startswith("It is more than six times")


def test_the_quality_of_a_picture_of_itself() -> None:
    """The view of the only reference, one pixel a point: no holes, overdraw 1, and no error where there are points."""
    scene = Scene(images=IMAGES[:1], camera=IMAGES[0].camera, light=None)
    pictures = quality.drawn(scene, silent)
    rows = {str(row[0]): row for row in quality.measured(pictures, IMAGES[0].arrays[0])}
    assert len(rows) == 7
    _, coverage, holes, overdraw, covered, everywhere, common = rows["constant 1 pixel"]
    assert (holes, overdraw, covered, everywhere, common) == (0.0, 1.0, np.inf, np.inf, np.inf)
    assert coverage == pytest.approx(IMAGES[0].arrays[2].mean())
    assert 10 < float(rows["constant 3 pixels"][4] or 0) < 40


def test_the_references_step(tmp_path: Path) -> None:
    found = selection.run(tmp_path, silent, size=24)
    shares, views = found.tables
    assert [row[0] for row in shares.rows] == sorted(row[0] for row in shares.rows)  # type: ignore[type-var]
    greedy, first, *_, whole = views.rows
    assert greedy[1] == first[1]
    assert whole[1] == 32
    assert (tmp_path / "chosen.png").is_file()


def test_the_best_sets_are_no_worse_than_the_greedy_ones() -> None:
    images = models.depth_rig(models.kettle(), 9, size=24)
    chosen = splatting.choose_references(images, 1.0)
    three, five = selection.best_of(images)
    assert three >= chosen.shares[2] - 1e-6
    assert five >= chosen.shares[min(4, len(chosen.shares) - 1)] - 1e-6
    assert three < five <= 1.0 + 1e-6


def test_pictures_are_put_together() -> None:
    dark, grey = np.zeros((2, 3, 3)), np.full((4, 1, 3), 0.5)
    row = canvas.side_by_side([dark, grey])
    assert row.shape == (4, 10, 3)
    assert (row[:2, :3] == 0.0).all()
    assert (row[2:, :3] == 1.0).all()
    assert (row[:, 9] == 0.5).all()
    assert canvas.grid([dark, dark, grey], 2).shape == (12, 12, 3)
    assert canvas.enlarged(dark, 3).shape == (6, 9, 3)
    assert canvas.cropped(np.arange(24).reshape(4, 6, 1), 1, 2, 2, 1)[..., 0].tolist() == [[13, 14]]
    edged = canvas.framed(np.zeros((9, 9, 3)), (1.0, 0.0, 0.0), 2)
    assert edged[:, :, 0].sum() == 81 - 25
