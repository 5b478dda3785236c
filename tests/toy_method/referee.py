"""Its judge: everything within the device's roundings of the formula."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement, Parameter, TraceRow, up_to

READS = {"shade.level": (), "color": ("shade.level",), "depth": ()}


class RampReferee:
    stages = ("shade", "resolve")

    def judge_stages(
        self, case: Case, device: Device, handed: Handed, *, to_first_wrong: bool = False
    ) -> list[Judgement]:
        arrays = {"shade": "shade.level", "resolve": "color"}
        found = (self._judge(stage, case, device, handed, (name,)) for stage, name in arrays.items() if name in handed)
        return up_to(found, first_wrong=to_first_wrong)

    def judge_image(self, case: Case, device: Device, handed: Handed) -> Judgement:
        names = tuple(name for name in ("color", "depth") if name in handed)
        return self._judge("image", case, device, handed, names)

    def _judge(self, stage: str, case: Case, device: Device, handed: Handed, names: tuple[str, ...]) -> Judgement:
        made = {"color": case.frame.color, "depth": case.frame.depth, **case.frame.stages}
        shape = case.frame.depth.shape
        blame, rounding = np.full(shape, -1, np.int8), (device.quotient + 2.0 * device.operation) * UNIT
        for i, name in reversed([*enumerate(names)]):
            theirs, slack = np.asarray(handed[name], np.float64), rounding
            if handed[name].dtype == np.uint8:
                theirs, slack = theirs / 255.0, slack + device.byte / 255.0
            off = abs(theirs - made[name]).reshape(*shape, -1).max(axis=-1)
            blame[~(off <= slack)] = i
        return Judgement(
            stage=stage, element="pixel", arrays=names, wrong=blame >= 0, undecided=np.zeros(shape, bool),
            width=np.full(shape, 2.0 * rounding), blame=blame,
        )  # fmt: skip

    def trace(self, case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
        array = "shade.level" if stage == "shade" else "color"
        made = {"color": case.frame.color, **case.frame.stages}
        return [
            TraceRow(step="the formula", reference=f"{made[array][index]}", port=f"{handed[array][index]}", array=array)
        ]

    def parameters(self, case: Case) -> list[Parameter]:
        def moved(gain: float) -> Case:
            return replace(case, params=replace(case.params, gain=gain))

        return [Parameter(name="gain", value=case.params.gain, step=0.01, moved=moved)]
