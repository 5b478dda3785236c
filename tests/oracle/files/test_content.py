"""Images that there is nothing to judge in."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.files import Problem, Submission, empty, stale, submission_from_arrays

pytestmark = pytest.mark.usefixtures("one_thread")


def with_color(case: Case, color: Any) -> Submission:
    return submission_from_arrays(case, color=color)


def emptiness(case: Case, submission: Submission) -> list[Problem]:
    """Of one that can be judged."""
    assert submission.usable
    return empty(case, submission.handed, submission.files)


@pytest.mark.parametrize(
    ("color", "word"), [((0.0, 0.0, 0.0), "black"), ((0.1, 0.2, 0.3), "background"), ((1.0, 0.0, 1.0), "one colour")]
)
@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_blank(maps_case: Case, color: tuple[float, ...], word: str, dtype: Any) -> None:
    image = np.broadcast_to(color, maps_case.frame.color.shape)
    image = color_bytes(image) if dtype == np.uint8 else image.astype(dtype)
    (problem,) = emptiness(maps_case, with_color(maps_case, image))
    assert "nothing rendered" in problem.found
    assert word in problem.found


def test_a_case_that_is_blank_itself() -> None:
    from tests.oracle.files.cases import displacement_maps

    case = displacement_maps()
    away = case.scene.__class__(
        polygons=case.scene.polygons, light=case.scene.light, background=(0.1, 0.2, 0.3),
        camera=case.scene.camera.look_at(eye=(0, 0, 9), target=(0, 1, 20), width=24, height=18),
    )  # fmt: skip
    blank = Case(name="x", method="displacement", kind="easy", about="x", profile="gl", scene=away, params=case.params)
    assert len(np.unique(blank.frame.color.reshape(-1, 3), axis=0)) == 1
    assert not emptiness(blank, with_color(blank, blank.frame.color))


def test_one_pixel_drawn_is_not_blank(maps_case: Case) -> None:
    image = np.zeros(maps_case.frame.color.shape, np.uint8)
    image[3, 4] = 1
    assert not emptiness(maps_case, with_color(maps_case, image))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_no_numbers(maps_case: Case, value: float) -> None:
    color, depth = maps_case.frame.color.copy(), maps_case.frame.depth.copy()
    color[2, 3, 1] = depth[5, 6] = value
    first, second = submission_from_arrays(maps_case, color=color, depth=depth).problems
    assert (first.file, second.file) == ("color", "depth")
    assert "[2, 3, 1]" in first.found
    assert "[5, 6]" in second.found


def test_bytes_as_floats(maps_case: Case) -> None:
    (problem,) = with_color(maps_case, color_bytes(maps_case.frame.color).astype(np.float32)).problems
    assert "as uint8" in problem.allowed


def test_too_bright_is_judged(maps_case: Case) -> None:
    assert with_color(maps_case, maps_case.frame.color * 3.0 - 0.5).usable


def test_too_little(maps_case: Case) -> None:
    for submission in (
        submission_from_arrays(maps_case),
        submission_from_arrays(maps_case, depth=maps_case.frame.depth),
    ):
        (problem,) = submission.problems
        assert "neither a final image nor a stage" in problem.found
    assert submission_from_arrays(maps_case, stages={"march.hit": maps_case.frame.stages["march.hit"]}).usable


def test_a_stage_without_numbers(maps_case: Case) -> None:
    hit = np.full_like(maps_case.frame.stages["march.hit"], np.nan)
    submission = submission_from_arrays(maps_case, color=maps_case.frame.color, stages={"march.hit": hit})
    (problem,) = emptiness(maps_case, submission)
    assert problem.file == "march.hit"


def test_the_image_of_another_case(maps_case: Case) -> None:
    from tests.oracle.files.cases import displacement_parallel

    other = displacement_parallel()
    others = [("maps", maps_case.frame.color), ("parallel", other.frame.color)]
    rng = np.random.default_rng(0)
    color = other.frame.color + rng.uniform(-1, 1, other.frame.color.shape) / 255
    problem = stale(maps_case, with_color(maps_case, np.clip(color, 0, 1)).handed, others)
    assert problem is not None
    assert "'parallel'" in problem.found
    own = maps_case.frame.color.copy()
    own[:9] = 1.0 - own[:9]
    assert stale(maps_case, with_color(maps_case, own).handed, others) is None
    assert stale(maps_case, with_color(maps_case, maps_case.frame.color).handed, others) is None
    assert stale(maps_case, {}, others) is None


def test_a_near_twin_is_not_taken_for_the_case(maps_case: Case) -> None:
    """A port's fault that makes its image that of a case which differs in a few pixels stays a fault."""
    twin = maps_case.frame.color.copy()
    twin[0, :5] = 1.0
    assert stale(maps_case, with_color(maps_case, twin).handed, [("twin", twin)]) is None
