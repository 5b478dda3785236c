"""A stage that is judged in parts: words and the report say which part."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle import check, report, submission_from_arrays
from ibr_ref.oracle.examination import Examination, examine
from ibr_ref.oracle.findings import Cause, Nearest, Outcome, StageVerdict
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.verdict import Verdict
from tests.oracle.plain_referee import box_case
from tests.oracle.tiny_cases import TINY


def part(array: str, element: str, elements: int, wrong: int = 0) -> StageVerdict:
    return StageVerdict(
        stage="warp", element=element, arrays=(array,), replayed=(), elements=elements, wrong=wrong, undecided=0,
        box=None, blamed={array: wrong} if wrong else {}, median_width=None,
    )  # fmt: skip


def test_parts_of_a_stage_are_named_by_their_arrays() -> None:
    stages = (part("warp.cell", "axis", 2), part("warp.rows", "texel", 4608, wrong=7))
    verdict = Verdict(outcome=Outcome.FAIL, case="a", method="shadows", profile="gl", stages=stages)
    assert "  warp (warp.cell): right (2 axes).\n" in verdict.words()
    assert "  warp (warp.rows): 7 texels wrong (0.152 %): warp.rows in 7.\n" in f"{verdict.words()}\n"
    alone = verdict.model_copy(update={"stages": stages[:1]})
    assert "  warp: right (2 axes)." in alone.words()


def test_the_first_wrong_part_is_shown() -> None:
    """Not the first part of the stage that has one."""
    case = box_case(8, 6)
    judgements = []
    for array, wrong in (("warp.cell", False), ("warp.rows", True)):
        size = np.zeros((6, 8))
        judgements.append(
            Judgement(
                stage="warp",
                element="texel",
                arrays=(array,),
                wrong=size + wrong > 0.0,
                undecided=size > 0.0,
                width=size,
                blame=np.zeros((6, 8), np.int8),
            )
        )
    verdict = examine(case, {}).verdict
    examination = Examination(case=case, handed={}, judgements=judgements, verdict=verdict)
    assert examination.first_wrong is judgements[1]
    assert Examination(case=case, handed={}, judgements=judgements[:1], verdict=verdict).first_wrong is None


def test_a_pair_and_what_comes_nearest_are_said() -> None:
    """In words and on the page."""
    verdict = Verdict(outcome=Outcome.FAIL, case="a", method="shadows", causes=())
    near = Nearest(name="bias-sign", says="Minus.", left=1200, element="pixel", index=(3, 4))
    told = verdict.model_copy(update={"nearest": near})
    assert "bias-sign comes nearest, and leaves 1,200, the first pixel [3, 4]. Minus." in told.words()
    pair = Cause(name="a and b", says="A. B.", together=("a", "b"))
    told = verdict.model_copy(update={"causes": (pair,)})
    assert "  Explained by two bugs together, by neither alone: a and b. A. B." in told.words()
    page = report.page(Examination(case=box_case(8, 6), handed={}, judgements=(), verdict=told))
    assert "Two bugs together: <strong>a and b</strong>" in page
    assert Verdict.model_validate_json(told.model_dump_json()) == told


def test_what_is_handed_in_and_not_judged_is_said() -> None:
    """What a search cost, and how close it was, is a port's own."""
    case = TINY["displacement-relaxed_cone"]()
    stages = {name: case.frame.stages[name] for name in ("march.hit", "march.fetches")}
    examination = check(case, submission_from_arrays(case, stages=stages), profile="ieee32")
    assert "  Not judged: march.fetches; a port's own may be any." in examination.verdict.words()
    assert "Not judged: march.fetches" in report.page(examination)
    alone = check(case, submission_from_arrays(case, stages={"march.hit": stages["march.hit"]}), profile="ieee32")
    assert "Not judged" not in alone.verdict.words() + report.page(alone)
    nothing = check(case, submission_from_arrays(case, stages={"march.fetches": stages["march.fetches"]})).verdict
    assert nothing.outcome is Outcome.INCONCLUSIVE
    assert nothing.reasons == (
        "found march.fetches alone, which no port has right or wrong, allowed: color, depth or any stage",
    )
