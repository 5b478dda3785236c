"""The referee of protruded displacement mapping.

Judged are `method="protruded"`: the systems that the paper compares with are not what ports are made of. A fragment's search
is followed through every comparison that rounding may turn: `march`; what is hit is shaded in every legal way: `shade`,
`light`; which of it a pixel may show the depth test decides: `shown`, `image`. `stages` feeds each stage with the port's own
arrays (`replay`).
"""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement, Parameter, TraceRow, up_to
from ibr_ref.oracle.referees.displacement import image, stages
from ibr_ref.oracle.referees.displacement.parameters import parameters
from ibr_ref.oracle.referees.displacement.trace import trace

__all__ = ["DisplacementReferee"]


class DisplacementReferee:
    """Judge of protruded displacement mapping."""

    stages = ("vertex", "raster", "march", "shade", "resolve")

    def judge_stages(
        self, case: Case, device: Device, handed: Handed, *, to_first_wrong: bool = False
    ) -> list[Judgement]:
        """Every stage of which an array is handed in, in order, each fed with the port's own arrays of the stages before."""
        with np.errstate(all="ignore"):  # infinite bounds meet zeros; a port's numbers may be anything
            return up_to(stages.judgements(case, device, handed), first_wrong=to_first_wrong)

    def judge_image(self, case: Case, device: Device, handed: Handed) -> Judgement:
        """The final colour, and depth where it is handed in, from the case alone."""
        with np.errstate(all="ignore"):
            return image.judge_image(case, device, handed)

    def trace(self, case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
        """The computation of one element of a stage, reference and port side by side."""
        with np.errstate(all="ignore"):
            return trace(case, device, handed, stage, index)

    def parameters(self, case: Case) -> list[Parameter]:
        """The continuous parameters that move the image."""
        return parameters(case)
