"""The referee of protruded displacement mapping.

Judged are `method="protruded"`: the systems that the paper compares with are not what ports are made of. The port's own
program runs on numbers with bounds (`model`), and every comparison that rounding may turn is followed both ways (`hits`).
`stages` feeds each stage with the port's own arrays (`replay`); `image` judges a picture by itself (`picture`). Suspects are
programs with a known bug, judged as the right one is (`cause`).
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Bools
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement, Parameter, TraceRow, up_to
from ibr_ref.oracle.programs.displacement import Port as Program
from ibr_ref.oracle.referees.displacement import image
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.parameters import parameters
from ibr_ref.oracle.referees.displacement.replay import Port
from ibr_ref.oracle.referees.displacement.stages import SAMPLED, Stages
from ibr_ref.oracle.referees.displacement.trace import trace

__all__ = ["DisplacementReferee"]


class DisplacementReferee:
    """Judge of protruded displacement mapping."""

    stages = ("vertex", "raster", "march", "shade", "resolve")

    def judge_stages(
        self,
        case: Case,
        device: Device,
        handed: Handed,
        *,
        to_first_wrong: bool = False,
        program: type[Program] = Program,
    ) -> list[Judgement]:
        """Every stage of which an array is handed in, in order, each fed with the port's own arrays of the stages before."""
        judged = Stages(Port(model=Model(case, device, program), handed=handed)).judgements()
        with np.errstate(all="ignore"):  # infinite bounds meet zeros; a port's numbers may be anything
            return up_to(judged, first_wrong=to_first_wrong)

    def judge_image(self, case: Case, device: Device, handed: Handed) -> Judgement:
        """The final colour, and depth where it is handed in, from the case alone."""
        with np.errstate(all="ignore"):
            return image.judge_image(case, device, handed)

    def explains(self, case: Case, device: Device, handed: Handed, stage: str, among: Bools) -> bool:
        """Whether no pixel `among` is wrong in a stage, or in the picture."""
        with np.errstate(all="ignore"):
            if stage == "image":
                return image.explains(case, device, handed, among)
            some = among if stage in SAMPLED else None
            return not Stages(Port(model=Model(case, device), handed=handed, among=some)).judge(stage).wrong.any()

    def trace(self, case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
        """The computation of one element of a stage, reference and port side by side."""
        with np.errstate(all="ignore"):
            return trace(case, device, handed, stage, index)

    def causes(self, case: Case, device: Device, handed: Handed, wrong: Judgement) -> Explanation | None:
        """The known bugs that explain a wrong stage, or a picture by itself."""
        from ibr_ref.oracle.referees.displacement.cause import causes  # with all known bugs: what passes needs none

        return causes(case, device, handed, wrong)

    def recognizes(self, case: Case, device: Device, handed: Handed, wrong: Judgement, cause: str) -> bool:
        """Whether the known bug of that name explains a wrong stage, or a picture by itself."""
        from ibr_ref.oracle.referees.displacement.cause import recognizes

        return recognizes(case, device, handed, wrong, cause)

    def parameters(self, case: Case) -> list[Parameter]:
        """The continuous parameters that move the image."""
        return parameters(case)
