"""A referee that only compares, with one tolerance: what the engine and the report are tested with."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import ibr_ref
from ibr_ref import displacement, models
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement, Parameter, TraceRow, up_to


def box_case(width: int = 96, height: int = 72, ambient: float = 0.2) -> Case:
    """The box, seen obliquely."""
    camera = ibr_ref.Camera.look_at(
        eye=(0.6, -0.75, 0.65), target=(0, 0, 0), near=0.1, far=10, width=width, height=height
    )
    light = ibr_ref.Light(position=(1.5, -0.5, 2.0), ambient=ambient)
    scene = displacement.Scene(polygons=[models.box()], camera=camera, light=light)
    return Case(
        name="displacement-test",
        method="displacement",
        kind="easy",
        about="A box for the oracle's own tests.",
        profile="ieee32",
        scene=scene,
        params=displacement.Params(linear_steps=9),
    )


class PlainReferee:
    """Everything within 1e-6 of the reference; "gl" allows 1e-3."""

    stages = ("raster", "march")

    def judge_stages(
        self, case: Case, device: Device, handed: Handed, *, to_first_wrong: bool = False
    ) -> list[Judgement]:
        arrays = {stage: tuple(name for name in handed if name.startswith(stage + ".")) for stage in self.stages}
        found = (self._judge(stage, case, device, handed, names) for stage, names in arrays.items() if names)
        return up_to(found, first_wrong=to_first_wrong)

    def judge_image(self, case: Case, device: Device, handed: Handed) -> Judgement:
        return self._judge("image", case, device, handed, ("color",))

    def _judge(self, stage: str, case: Case, device: Device, handed: Handed, names: tuple[str, ...]) -> Judgement:
        off = 1e-3 if device.name == "gl" else 1e-6
        size = case.frame.color.shape[:2]
        blame = np.full(size, -1, np.int8)
        for i, name in reversed([*enumerate(names)]):
            ours = case.frame.color if name == "color" else case.frame.stages[name]
            theirs = np.asarray(handed[name], np.float64) / (255.0 if handed[name].dtype == np.uint8 else 1.0)
            slack = device.byte / 255.0 + 1e-9 if handed[name].dtype == np.uint8 else off
            with np.errstate(invalid="ignore"):
                same = (theirs == ours) | (abs(theirs - ours) <= slack) | (np.isnan(ours) & np.isnan(theirs))
            blame[~same.reshape(*size, -1).all(axis=-1)] = i
        undecided = np.zeros(size, bool)
        undecided[:2] = True
        return Judgement(
            stage=stage,
            element="pixel",
            arrays=names,
            wrong=blame >= 0,
            undecided=undecided,
            width=np.full(size, 2 * off),
            blame=blame,
        )

    def trace(self, case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
        return [
            TraceRow(step="h < H", reference="0.5 < 0.25", port="0.5 < 0.75", margin=0.25, bound=1e-6, note="differs")
        ]

    def parameters(self, case: Case) -> list[Parameter]:
        def moved(ambient: float) -> Case:
            light = dataclasses.replace(case.scene.light, ambient=ambient)
            return dataclasses.replace(case, scene=dataclasses.replace(case.scene, light=light))

        return [Parameter(name="light.ambient", value=case.scene.light.ambient, step=0.01, moved=moved)]


def judges_all(patch: pytest.MonkeyPatch) -> PlainReferee:
    """Let the whole engine judge by plain comparison."""
    judge = PlainReferee()
    for module in ("examination", "trials", "conventions", "bias"):
        patch.setattr(f"ibr_ref.oracle.{module}.referee", lambda method: judge)
    return judge
