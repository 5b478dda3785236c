"""The referee of splatting.

The port's own program runs on numbers with bounds (`model`), and every comparison that rounding may turn is followed both
ways. Every stage is fed with the port's own arrays (`table`, `points`, `pixels`); suspects are programs with a known bug,
judged as the right one is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ibr_ref.array_types import Bools
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement, Parameter, TraceRow, up_to
from ibr_ref.oracle.referees.splatting.model import model_of
from ibr_ref.oracle.referees.splatting.parameters import parameters
from ibr_ref.oracle.referees.splatting.stages import SAMPLED, STAGES, Stages
from ibr_ref.oracle.referees.splatting.trace import trace

__all__ = ["SplattingReferee"]


class SplattingReferee:
    """Judges ports of splatting; fulfils `ibr_ref.oracle.judgement.Referee`."""

    stages: Sequence[str] = STAGES

    def judge_stages(
        self, case: Case, device: Device, handed: Handed, *, to_first_wrong: bool = False
    ) -> list[Judgement]:
        """Every stage of which an array is handed in, each fed with the port's own arrays of the stages before."""
        with np.errstate(all="ignore"):  # a port's numbers may be anything
            return up_to(Stages(model_of(case, device), handed).judgements(), first_wrong=to_first_wrong)

    def judge_image(self, case: Case, device: Device, handed: Handed) -> Judgement:
        """The picture, and depth where it is handed in, from the case alone."""
        with np.errstate(all="ignore"):
            return Stages(model_of(case, device), handed).judge("image")

    def explains(self, case: Case, device: Device, handed: Handed, stage: str, among: Bools) -> bool:
        """Whether no element `among` is wrong in a stage, or in the picture."""
        some = among if stage in SAMPLED else None
        with np.errstate(all="ignore"):
            return not Stages(model_of(case, device), handed, some).judge(stage).wrong.any()

    def trace(self, case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
        """The computation of one element of a stage, reference and port side by side."""
        with np.errstate(all="ignore"):
            return trace(model_of(case, device), handed, stage, index)

    def causes(self, case: Case, device: Device, handed: Handed, wrong: Judgement) -> Explanation | None:
        """The known bugs that explain a wrong stage."""
        from ibr_ref.oracle.referees.splatting.cause import causes  # with all known bugs: what passes needs none

        return causes(case, device, handed, wrong)

    def recognizes(self, case: Case, device: Device, handed: Handed, wrong: Judgement, cause: str) -> bool:
        """Whether the known bug of a name explains a wrong stage."""
        from ibr_ref.oracle.referees.splatting.cause import recognizes

        return recognizes(case, device, handed, wrong, cause)

    def parameters(self, case: Case) -> list[Parameter]:
        """The continuous parameters that move the image."""
        return parameters(case)
