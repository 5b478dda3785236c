"""Which device explains a port: a trial by each profile that is in question."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.declaration import ANY, NUMBERS, Declaration
from ibr_ref.oracle.device import LOOSEST, PROFILES, Device
from ibr_ref.oracle.judgement import Glances, Handed, Judgement, spread_out
from ibr_ref.oracle.referees import referee

LIKELY = [name for name, device in PROFILES.items() if device.likely]
"""What the loosest does not explain is wrong, and no other is tried after it has failed. By one of the likely ones most
right ports are explained: with stages they are tried before it, because where they fail they mostly do so in one of the
first stages. A picture takes all profiles the same time, and a broken one only the loosest."""

FREEDOMS: dict[str, Any] = {"subpixel_bits": 4, "filter_result": "unorm8"}
"""What devices in use do and no profile grants: rasterize with the standards' least precision, filter bytes in bytes."""

LIMITS: dict[str, Any] = {
    "depth_format": "unorm16",
    "texel_weight_bits": 8,
    "varyings": "either",
    "clip_z": "minus_one_to_one",
    "clip_border": "allowed",
    "setup": "whole",
    "unorm_rounding": "either",
}
"""What some device does of all else that can be declared: a port may say too little of its own."""

FEW = 24
"""Wrong elements that are looked at before all."""


@dataclass(frozen=True, eq=False)
class Trial:
    """What one device says."""

    device: Device
    judgements: list[Judgement]
    """The stages in order, then "image" where a colour was handed in; none after the first that is wrong, where no more was
    asked for."""

    @property
    def wrong(self) -> int:
        """Elements that the device does not explain."""
        return sum(int(j.wrong.sum()) for j in self.judgements)

    @property
    def first_wrong(self) -> int | None:
        """Of the judgements the first that has such elements."""
        return next((i for i, j in enumerate(self.judgements) if j.wrong.any()), None)


def judge(case: Case, handed: Handed, device: Device, *, to_first_wrong: bool = False) -> list[Judgement]:
    """All that one device allows: the stages in order, each on the port's own inputs, then "image" if a colour is there.

    Where nothing but the picture and its depth was handed in there are no stages to tell apart.
    """
    judge_of = referee(case.method)
    found: list[Judgement] = []
    if not _picture_alone(handed):
        found = judge_of.judge_stages(case, device, handed, to_first_wrong=to_first_wrong)
    if "color" in handed and not (to_first_wrong and any(j.wrong.any() for j in found)):
        found.append(judge_of.judge_image(case, device, handed))
    return found


def _picture_alone(handed: Handed) -> bool:
    return "color" in handed and {*handed} <= {"color", "depth"}


def tightest(case: Case, handed: Handed, declaration: Declaration = ANY) -> tuple[Trial, dict[str, int]]:
    """The tightest device that leaves no element unexplained, or the loosest profile; and what each one tried left.

    declaration: numbers that every device has. Where no profile explains the port, those are tried that have what standards
    allow and desktop devices do not have (`FREEDOMS`): as few of them as will do, with the tightest profile. Trials end with
    the first judgement that is wrong, but the loosest profile's: what no device explains is wrong, and the verdict rests on
    it.
    """
    tried: dict[str, int] = {}

    def trial(name: str, **more: Any) -> Trial:
        device = _with(declaration.device(name), more)
        found = Trial(device, judge(case, handed, device, to_first_wrong=name != LOOSEST or bool(more)))
        tried[device.words] = found.wrong
        return found

    for name in () if _picture_alone(handed) else LIKELY:
        if not (found := trial(name)).wrong:
            return found, tried
    loosest = trial(LOOSEST)
    more: dict[str, Any] = {}
    if loosest.wrong:
        more = _free(declaration.numbers)
        if not more or _refuted(case, handed, loosest, more) or (right := trial(LOOSEST, **more)).wrong:
            return loosest, tried
        for key, value in more.items() if len(more) > 1 else ():
            if not (alone := trial(LOOSEST, **{key: value})).wrong:
                more, right = {key: value}, alone
                break
        loosest = right
    for name in PROFILES:
        if _with(declaration.device(name), more).words not in tried and not (found := trial(name, **more)).wrong:
            return found, tried
    return loosest, tried


def _free(numbers: Mapping[str, Any]) -> dict[str, Any]:
    """The freedoms that nothing was said about."""
    return {key: value for key, value in FREEDOMS.items() if key not in numbers}


def _with(device: Device, more: Mapping[str, Any]) -> Device:
    return Declaration(device.name, {**device.numbers, **more}).device(device.name)


def _refuted(case: Case, handed: Handed, failed: Trial, more: Mapping[str, Any]) -> bool:
    """Whether a few elements of the first wrong judgement are wrong with more numbers too, where that is soon known."""
    judge_of, at = referee(case.method), failed.first_wrong
    if at is None or not isinstance(judge_of, Glances):
        return False
    judgement = failed.judgements[at]
    few = spread_out([judgement.wrong.reshape(-1)], FEW)
    return not judge_of.explains(case, _with(failed.device, more), handed, judgement.part or judgement.stage, few)


def needed(case: Case, handed: Handed, failed: Trial, *, limits: bool = False) -> dict[str, Any]:
    """What a device would need beside its numbers for the first wrong judgement of a trial to be right; nothing: no such.

    limits: not only `FREEDOMS` are tried, but also what else it has less of than others.
    """
    wrong = failed.first_wrong
    assert wrong is not None, "a trial that nothing is wrong in needs no more"

    def right(judgements: list[Judgement]) -> bool:
        return len(judgements) > wrong and not judgements[wrong].wrong.any()

    def explains(more: Mapping[str, Any]) -> bool:
        if _refuted(case, handed, failed, more):
            return False
        return right(judge(case, handed, _with(failed.device, more), to_first_wrong=True))

    for granted in (FREEDOMS, LIMITS) if limits else (FREEDOMS,):
        more = {key: value for key, value in granted.items() if _coarser(failed.device, key, value)}
        if more and explains(more):
            return _fewest(more, explains)
    return {}


def _fewest(more: dict[str, Any], explains: Callable[[Mapping[str, Any]], bool]) -> dict[str, Any]:
    """One of some numbers that explain something together, or as few as need be."""
    for key, value in more.items() if len(more) > 1 else ():
        if explains({key: value}):
            return {key: value}
    for key in [*more] if len(more) > 2 else ():
        fewer = {name: value for name, value in more.items() if name != key}
        if explains(fewer):
            more = fewer
    return more


def _coarser(device: Device, name: str, value: Any) -> bool:
    """Whether a number that a device says nothing of would grant it more."""
    changes = NUMBERS[name].change(device, value)
    return name not in device.numbers and any(getattr(device, field) != new for field, new in changes.items())
