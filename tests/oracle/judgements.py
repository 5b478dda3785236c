"""What tests of referees hand in, and what they read of judgements."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.device import IEEE32
from ibr_ref.oracle.faults.kinds import Variant
from ibr_ref.oracle.judgement import Explains, Judgement
from ibr_ref.oracle.referees import referee
from ibr_ref.oracle.trials import judge

Arrays = dict[str, np.ndarray]


def picture(arrays: Arrays) -> Arrays:
    """The final image alone."""
    return {name: arrays[name] for name in ("color", "depth")}


def in_bytes(arrays: Arrays) -> Arrays:
    """The final colour as a PNG has it."""
    return {"color": color_bytes(np.nan_to_num(arrays["color"]))}


def pictures(arrays: Arrays, variant: Variant) -> list[Arrays]:
    """A picture in floats and one in bytes, with the normals or maps that a variant has made itself."""
    own = {name: arrays[name] for name in variant.own if name in arrays}  # method "direct" warps no maps
    return [picture(arrays) | own, (picture(arrays) if variant.policy.color_bits else in_bytes(arrays)) | own]


def complaints(judgements: list[Judgement]) -> list[str]:
    """What is wrong, in words that a failing test shows."""
    return [
        f"{j.stage}: {int(j.wrong.sum())} {j.element}s, by {[j.arrays[i] for i in np.unique(j.blame[j.wrong])]}, "
        f"first {np.argwhere(j.wrong)[0].tolist()}"
        for j in judgements
        if j.wrong.any()
    ]


def first_wrong(judgements: list[Judgement]) -> str | None:
    return next((j.stage for j in judgements if j.wrong.any()), None)


def named(case: Case, arrays: Arrays) -> list[str]:
    """What a FAIL names, by ieee32: the causes of the first wrong stage, or of the picture where that is all there is."""
    judge_of = referee(case.method)
    assert isinstance(judge_of, Explains)
    wrong = next(j for j in judge(case, arrays, IEEE32, to_first_wrong=True) if j.wrong.any())
    found = judge_of.causes(case, IEEE32, arrays, wrong)
    assert found is not None
    assert found.given_up_after is None
    return [cause.name for cause in found.causes]
