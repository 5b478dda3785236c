"""The judge of splatting."""

from __future__ import annotations

from collections.abc import Sequence

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement, Parameter, TraceRow, up_to
from ibr_ref.oracle.referees.splatting import atlas, image, normals, raster, vertex
from ibr_ref.oracle.referees.splatting.parameters import parameters
from ibr_ref.oracle.referees.splatting.trace import trace

JUDGES = {
    "normals": (("atlas.normal",), normals.judge),
    "atlas": (atlas.ARRAYS, atlas.judge),
    "vertex": (vertex.ARRAYS, vertex.judge),
    "raster": (raster.ARRAYS, raster.judge),
    "resolve": (("color", "depth"), image.judge_resolve),
}
"""For each stage the arrays that it is compared by, and how."""


class SplattingReferee:
    """Judges ports of splatting; fulfils `ibr_ref.oracle.judgement.Referee`."""

    stages: Sequence[str] = tuple(JUDGES)

    def judge_stages(
        self, case: Case, device: Device, handed: Handed, *, to_first_wrong: bool = False
    ) -> list[Judgement]:
        """Every stage of which an array is handed in, each fed with the port's own arrays of the stages before."""
        judges = [judge for arrays, judge in JUDGES.values() if any(name in handed for name in arrays)]
        return up_to((judge(case, device, handed) for judge in judges), first_wrong=to_first_wrong)

    def judge_image(self, case: Case, device: Device, handed: Handed) -> Judgement:
        """The picture, and depth where it is handed in, from the case alone."""
        return image.judge_image(case, device, handed)

    def trace(self, case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
        """The computation of one element of a stage, reference and port side by side."""
        return trace(case, device, handed, stage, index)

    def parameters(self, case: Case) -> list[Parameter]:
        """The continuous parameters that move the image."""
        return parameters(case)
