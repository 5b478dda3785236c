"""Bugs are found, told apart, made small and not found again; a right port has none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from ibr_ref import oracle
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.files import Submission
from ibr_ref.testing import Bug, Hunt, PortError, assert_port, bug_of, drawing, judging
from ibr_ref.testing.judging import failure_of, with_causes
from tests.oracle.tiny_cases import TINY, handed_of
from tests.testing.test_cases import plain

pytestmark = pytest.mark.usefixtures("one_thread")

BEFORE = ("vertex", "raster", "march")
STEEP = Bug("displacement", "march", "march.steep")
CLIP = Bug("displacement", "vertex", "vertex.clip")


def reference(case: Case) -> dict[str, Any]:
    """What a port may hand in that is the reference."""
    return handed_of(case)


def steep(case: Case) -> dict[str, Any]:
    """Walls are flat, where the search has taken three steps; it has no stages after that."""
    arrays = {name: array for name, array in reference(case).items() if name.partition(".")[0] in BEFORE}
    arrays["march.steep"] ^= arrays["march.hit_index"] >= 3
    return arrays


def steep_and_clip(case: Case) -> dict[str, Any]:
    """Another bug, in the stage before, on pictures of more than one column."""
    arrays = steep(case)
    if case.scene.camera.width > 1:
        arrays["vertex.clip"] *= 1.01
    return arrays


def inverted(case: Case) -> dict[str, Any]:
    """Walls are flat and roofs are steep, on any case."""
    return {"march.steep": ~reference(case)["march.steep"]}


class Clock:
    """In place of time: a second passes with each look."""

    def __init__(self) -> None:
        self.now = 0.0

    def monotonic(self) -> float:
        self.now += 1.0
        return self.now


def hunt(draw: Callable[[Case], dict[str, Any]], **more: Any) -> Hunt:
    options = {"shrinking": 80.0, "clock": Clock().monotonic, **more}
    return Hunt(port=drawing(draw), methods=("displacement",), **options)


@pytest.mark.long
def test_a_bug_is_found_and_made_small() -> None:
    chase = hunt(steep)
    (found,) = chase.run(40)
    assert found.bug.place == STEEP.place
    assert all(cause.startswith("delta on ") for cause in found.bug.causes)
    assert chase.known == {found.bug}
    camera = found.case.scene.camera
    assert camera.width * camera.height <= 4
    assert bug_of(found.case, drawing(steep), None) == STEEP
    assert not [*hunt(steep, known={STEEP}).run(15)]


@pytest.mark.long
def test_two_bugs_are_two() -> None:
    found = [each.bug for each in hunt(steep_and_clip, shrinking=5.0).run(60)]
    assert sorted(found) == [STEEP, CLIP]


def drawn_by(kind: Any) -> Callable[[Case], dict[str, Any]]:
    """What a program draws, in float32."""
    return lambda case: kind(case.scene, case.params, Policy(), case.inputs).render()


def test_bugs_of_one_array_are_told_apart_by_their_causes() -> None:
    """What a known bug explains is skipped; what it does not is another bug, be it in the same array."""
    names = "stops a little above the surface", "height of the hit from the map"
    one, other = (next(m for m in MUTANTS if m.name == name) for name in names)
    case = TINY["displacement-hill"]()
    first = failure_of(case, drawing(drawn_by(one.port)), "ieee32")
    assert first is not None
    bug = with_causes(case, first)
    assert bug.causes == (one.name,)
    assert bug.name == "displacement-march.linear_index-stops-a-little-above-the-surface"
    assert failure_of(case, drawing(drawn_by(one.port)), "ieee32", [bug]) is None
    unnamed = bug._replace(causes=())
    assert failure_of(case, drawing(drawn_by(one.port)), "ieee32", [unnamed]) is None
    elsewhere = bug._replace(causes=(other.name,))
    again = failure_of(case, drawing(drawn_by(one.port)), "ieee32", [elsewhere])
    assert again is not None
    assert again.bug.place == bug.place


def test_arrays_that_are_all_right_make_a_right_picture() -> None:
    """The picture is not judged besides, whatever else is handed in; without one of them it is."""
    case = TINY["displacement-hill"]()
    arrays = reference(case)
    assert judging._whole(case, arrays)
    for name in ("march.hit", "shade.lit", "depth"):
        assert not judging._whole(case, {key: array for key, array in arrays.items() if key != name})
    wrong = {**arrays, "color": 0.5 * arrays["color"]}
    assert bug_of(case, drawing(lambda case: wrong), None) == Bug("displacement", "shade", "color")


@pytest.mark.long
def test_a_right_port_has_none_and_the_time_is_kept() -> None:
    chase = hunt(reference)
    assert not [*chase.run(20)]
    assert 15 <= chase.tried <= 20


@pytest.mark.long
def test_it_goes_on_with_what_failed_before(tmp_path: Path) -> None:
    """The example that was being made smaller is the first that is tried next time."""
    first = next(iter(hunt(steep, database=tmp_path, shrinking=3.0).run(30)))  # and is ended there
    assert first.bug.place == STEEP.place
    again = next(iter(hunt(steep, database=tmp_path, shrinking=3.0, seed=99).run(30)))
    assert again.after == 1


def test_going_on_forgets_no_example(tmp_path: Path) -> None:
    """A bug that is known is no failure from then on, and an example of it all the same."""

    def ends(case: Case) -> Submission:
        if case.params.linear_steps >= 3:
            raise PortError("exit code 3")
        return drawing(reference)(case)

    chase = iter(replace(hunt(reference, database=tmp_path, shrinking=3.0), port=ends).run(15))
    assert next(chase).bug.array == "exit code 3"
    kept = {*tmp_path.rglob("*")}
    assert not [*chase]
    assert kept <= {*tmp_path.rglob("*")}


def test_a_port_that_does_not_draw_and_one_whose_files_are_unusable() -> None:
    case = TINY["displacement-hill"]()

    def ends(case: Case) -> Any:
        raise PortError("exit code 3")

    assert bug_of(case, ends, None) == Bug("displacement", "port", "exit code 3")
    assert bug_of(case, drawing(lambda case: {"color": case.frame.color[1:]}), None) == Bug(
        "displacement", "submission", "color"
    )
    assert Bug("displacement", "port", "exit code 3").name == "displacement-port-exit-code-3"
    assert STEEP.name == "displacement-march.steep"
    assert STEEP._replace(causes=("a",)).name == "displacement-march.steep-a"
    assert STEEP._replace(causes=("a", "b", "c")).name == "displacement-march.steep-a-or-another"


def test_a_picture_alone_is_judged_too() -> None:
    case = TINY["displacement-hill"]()
    assert bug_of(case, drawing(lambda case: {"color": 0.5 * case.frame.color}), None) == Bug(
        "displacement", "image", "color"
    )


@pytest.mark.long
def test_assert_port(tmp_path: Path) -> None:
    assert_port(plain, method="splatting", device="ieee32", max_examples=5)
    with pytest.raises(AssertionError, match=r"(?s)FAIL: displacement-march.steep, .*Case: ") as failure:
        assert_port(inverted, method="displacement", max_examples=5, folder=tmp_path)
    place = Path(str(failure.value).rpartition("Case: ")[2])
    assert place == tmp_path / "displacement-march.steep"
    case = oracle.load_case(place)
    assert bug_of(case, drawing(inverted), None) == STEEP
    assert case.frame.depth.shape == (1, 1)
    with pytest.raises(ValueError, match="method: found 'rays'"):
        assert_port(plain, method="rays")
