"""From what a port handed in to a verdict: profiles, stages, conventions and biases, in this order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.contract import is_margin
from ibr_ref.oracle.bias import biases
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.conventions import conventions
from ibr_ref.oracle.declaration import ANY, Declaration, declared
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.findings import Bias, Box, Outcome, StageVerdict, TraceStep, Witness
from ibr_ref.oracle.judgement import Explains, Explanation, Handed, Judgement, TraceRow
from ibr_ref.oracle.power import drawn, share_of_drawn
from ibr_ref.oracle.referees import referee
from ibr_ref.oracle.referees.rows import heading, text
from ibr_ref.oracle.trials import Trial, judge, needed, tightest
from ibr_ref.oracle.verdict import Verdict


@dataclass(frozen=True, kw_only=True, eq=False)
class Examination:
    """A verdict with the arrays that it rests on."""

    case: Case
    handed: Handed
    judgements: Sequence[Judgement]
    """By the verdict's profile: the stages in order, then "image" where a colour was handed in."""
    verdict: Verdict

    def judgement(self, stage: str) -> Judgement | None:
        """Of a stage, or None."""
        return next((j for j in self.judgements if j.stage == stage), None)

    @property
    def first_wrong(self) -> Judgement | None:
        """In the pipeline's order."""
        return _first_wrong(self.judgements)


# A port's numbers may be anything: what overflows or is no number on the way is told as an infinite bound, or as wrong.
@np.errstate(all="ignore")
def examine(
    case: Case,
    handed: Handed,
    *,
    profile: str | Declaration | None = None,
    problems: Sequence[str] = (),
    name_causes: bool = True,
) -> Examination:
    """Judge a port's arrays, as `submission_from_arrays` or `load_submission` hands them on.

    profile: the device that the port declares, as `declaration.declared` reads it; without a profile in it, the tightest
    that explains every element is sought, and a port that no device explains fails by the loosest profile. problems: what
    made files of the submission unusable; with any, the verdict is INCONCLUSIVE, because what could not be read may be
    wrong. name_causes: whether known bugs that explain a FAIL are looked for, which takes seconds. Raises ValueError for an
    unknown device.
    """
    declaration = declared(profile) if isinstance(profile, str) else profile or ANY
    if problems or all(map(is_margin, handed)):
        alone = f"{', '.join(handed)} alone, which no port has right or wrong" if handed else "nothing"
        reasons = tuple(problems) or (f"found {alone}, allowed: color, depth or any stage",)
        return Examination(case=case, handed=handed, judgements=(), verdict=_unusable(case, reasons))
    if declaration.profile:
        trial, tried = _declared(case, handed, declaration.device(declaration.profile))
    else:
        trial, tried = tightest(case, handed, declaration)
    judgements = trial.judgements
    wrong = _first_wrong(judgements)
    sought = [j for j in judgements if name_causes and j.wrong.any() and (j is wrong or j.stage != "image")]
    explained = {j.stage: _explanation(case, trial.device, handed, j) for j in sought}
    fields: dict[str, Any] = {
        "case": case.name,
        "method": case.method,
        "profile": trial.device.name,
        "numbers": trial.device.numbers,
        "declared": declaration.profile is not None,
        "tried": tried,
        "stages": tuple(_summary(case, trial.device, handed, j, explained.get(j.stage)) for j in judgements),
    }
    fields["not_judged"] = tuple(name for name in handed if is_margin(name))
    image = next((j for j in judgements if j.stage == "image"), None)
    if image is not None:
        # Of what is drawn: a background is decided anywhere, and its width is none.
        fields["undecided_share"] = share_of_drawn(case, image)
        fields["median_width"] = _median(image.width[drawn(case, image)])
    found: tuple[Bias, ...] = ()
    if image is not None:
        found = biases(case, handed, image, trial.device, wrong=wrong is not None)
        fields["biases"] = found
    if wrong is None and not found:
        return Examination(
            case=case, handed=handed, judgements=judgements, verdict=Verdict(outcome=Outcome.PASS, **fields)
        )
    if wrong is not None:
        fields["first_wrong_stage"] = wrong.stage
        explanation = explained.get(wrong.stage)
        fields["needs"] = needed(case, handed, trial, limits=explanation is not None and not explanation.causes)
        if explanation is not None:
            fields |= {"causes": explanation.causes, "suspects": explanation.given_up_after}
            fields["nearest"] = explanation.nearest
        if image is not None and image.wrong.any():
            fields["conventions"] = conventions(case, trial.device, handed, int(image.wrong.sum()))
    else:
        fields["first_wrong_stage"] = "image"
    return Examination(case=case, handed=handed, judgements=judgements, verdict=Verdict(outcome=Outcome.FAIL, **fields))


def _declared(case: Case, handed: Handed, device: Device) -> tuple[Trial, dict[str, int]]:
    trial = Trial(device, judge(case, handed, device))
    return trial, {device.words: trial.wrong}


def _unusable(case: Case, reasons: tuple[str, ...]) -> Verdict:
    return Verdict(outcome=Outcome.INCONCLUSIVE, case=case.name, method=case.method, reasons=reasons)


def _first_wrong(judgements: Sequence[Judgement]) -> Judgement | None:
    return next((j for j in judgements if j.wrong.any()), None)


def _median(widths: NDArray[np.float64]) -> float | None:
    widths = widths[np.isfinite(widths)]
    return float(np.median(widths)) if widths.size else None


def _summary(
    case: Case, device: Device, handed: Handed, judgement: Judgement, explanation: Explanation | None
) -> StageVerdict:
    wrong = np.argwhere(judgement.wrong)
    box = None
    if judgement.places is not None:
        wrong = judgement.places[judgement.wrong]
    if len(wrong):
        box = Box(first=tuple(wrong.min(axis=0).tolist()), last=tuple(wrong.max(axis=0).tolist()))
    counts = np.bincount(judgement.blame[judgement.wrong].clip(0), minlength=len(judgement.arrays))
    return StageVerdict(
        stage=judgement.stage,
        element=judgement.element,
        arrays=judgement.arrays,
        replayed=judgement.replayed,
        elements=judgement.wrong.size,
        wrong=len(wrong),
        undecided=int(judgement.undecided.sum()),
        box=box,
        blamed={name: int(count) for name, count in zip(judgement.arrays, counts, strict=False) if count},
        median_width=_median(judgement.width),
        witness=_witness(case, device, handed, judgement) if len(wrong) else None,
        causes=None if explanation is None else explanation.causes,
        nearest=None if explanation is None else explanation.nearest,
    )


def _witness(case: Case, device: Device, handed: Handed, judgement: Judgement) -> Witness:
    """The first wrong element that no undecided one touches, else the first."""
    doubtful = judgement.undecided.copy()
    for axis in range(doubtful.ndim):
        doubtful |= np.roll(judgement.undecided, 1, axis) | np.roll(judgement.undecided, -1, axis)
    clear = np.argwhere(judgement.wrong & ~doubtful)
    index = tuple(int(i) for i in (clear if len(clear) else np.argwhere(judgement.wrong))[0])
    array = judgement.arrays[max(int(judgement.blame[index]), 0)]
    rows = referee(case.method).trace(case, device, handed, judgement.part or judgement.stage, index)
    # The head is a row of the trace: what the port is compared with is replayed, and need not be what the frame has.
    head = heading(rows, array) or _from_the_frame(case, handed, array, judgement.place(index))
    return Witness(
        stage=judgement.stage,
        element=head.element or judgement.element,
        index=judgement.place(index) if head.index is None else head.index,
        array=array,
        reference=head.reference or "nothing",
        port=head.port or "nothing",
        trace=tuple(
            TraceStep(
                step=r.step,
                reference=r.reference,
                port=r.port,
                margin=_finite(r.margin),
                bound=_finite(r.bound),
                note=r.note,
            )
            for r in rows
        ),
    )


def _explanation(case: Case, device: Device, handed: Handed, wrong: Judgement) -> Explanation | None:
    """Of the methods whose known bugs are programs."""
    judge_of = referee(case.method)
    return judge_of.causes(case, device, handed, wrong) if isinstance(judge_of, Explains) else None


def _finite(number: float | None) -> float | None:
    """What JSON can hold: where nothing bounds a result, there is no bound."""
    return number if number is not None and np.isfinite(number) else None


def _from_the_frame(case: Case, handed: Handed, array: str, index: tuple[int, ...]) -> TraceRow:
    """What a trace that has no row of the array would begin with."""
    frame = {"color": case.frame.color, "depth": case.frame.depth, **case.frame.stages}
    found = [arrays[array] for arrays in (frame, handed)]
    mine, theirs = (text(a[index[0]][index[1:]] if isinstance(a, tuple) else np.asarray(a)[index]) for a in found)
    return TraceRow(step=array, reference=mine, port=theirs, array=array)
