"""Which device explains a port: a trial by each profile that is in question."""

from __future__ import annotations

from dataclasses import dataclass

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import LOOSEST, PROFILES, Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees import referee

LIKELY = [name for name, device in PROFILES.items() if device.likely]
"""What the loosest does not explain is wrong, and no other is tried after it has failed. By one of the likely ones most
right ports are explained: with stages they are tried before it, because where they fail they mostly do so in one of the
first stages. A picture takes all profiles the same time, and a broken one only the loosest."""


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


def tightest(case: Case, handed: Handed) -> tuple[Trial, dict[str, int]]:
    """The tightest profile that leaves no element unexplained, or the loosest of all; and what each one tried left.

    Trials end with the first judgement that is wrong, but the loosest's: what it does not explain is wrong, and the verdict
    rests on it.
    """
    tried: dict[str, int] = {}

    def trial(name: str) -> Trial:
        found = Trial(PROFILES[name], judge(case, handed, PROFILES[name], to_first_wrong=name != LOOSEST))
        tried[name] = found.wrong
        return found

    for name in () if _picture_alone(handed) else LIKELY:
        if not (found := trial(name)).wrong:
            return found, tried
    loosest = trial(LOOSEST)
    if not loosest.wrong:
        for name in PROFILES:
            if name not in tried and not (found := trial(name)).wrong:
                return found, tried
    return loosest, tried
