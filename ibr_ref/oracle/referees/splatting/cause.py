"""The known bugs that explain a wrong stage, or a picture by itself."""

from __future__ import annotations

from typing import Any

from ibr_ref.array_types import Bools
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.faults.splatting import MUTANTS
from ibr_ref.oracle.faults.splatting.vectors import lit_from, seen_from
from ibr_ref.oracle.faults.taken import Setting
from ibr_ref.oracle.faults.vectors import Vector
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement
from ibr_ref.oracle.programs.splatting import Port as Program
from ibr_ref.oracle.referees.causes import Numbers, explained
from ibr_ref.oracle.referees.splatting.model import Model, model_of
from ibr_ref.oracle.referees.splatting.stages import ARRAYS, SAMPLED, Stages
from ibr_ref.oracle.referees.suspects import Inquiry
from ibr_ref.scene import Light

LAW = ("alpha", "beta", "gamma", "delta")
"""Numbers of the widths' law."""
ELLIPSES = {
    "footprint": ("vertex", ("variances",)),
    "low_pass": ("vertex", ("variances",)),
    "max_width": ("vertex", ("shrink",)),
    "cutoff": ("vertex", ("shrink", "larger_side", "covers", "spans")),
    "depth_tolerance": ("raster", ("reach",)),
}
"""Numbers of ellipses, the first stage that reads each, and the methods."""
WIDTHS = ("min_width", "max_width")
LIT = {"ambient": "received", "diffuse": "received", "specular": "highlight", "exponent": "exponent"}
"""Numbers of the light, and the method that reads each."""


def causes(case: Case, device: Device, handed: Handed, wrong: Judgement) -> Explanation | None:
    """The bugs that explain every element of a stage.

    Bugs of the stage first, then, where none of them does, those that may hide in it; of a picture those of all stages. And
    the numbers of the case that do, or that the port's results look like.
    """
    inquiry, numbers = _inquiry(case, device, handed), _numbers(case, handed, wrong.stage)
    if wrong.stage == "image":
        return explained(inquiry, numbers, wrong, ARRAYS)
    return explained(inquiry, numbers, wrong, (wrong.stage,), inquiry.hidden_in(wrong.stage, handed))


def recognizes(case: Case, device: Device, handed: Handed, wrong: Judgement, cause: str) -> bool:
    """Whether the bug of that name explains every element of a stage, or of a picture."""
    return _numbers(case, handed, wrong.stage).recognizes(_inquiry(case, device, handed), wrong, cause)


def _numbers(case: Case, handed: Handed, stage: str) -> Numbers:
    """Those of the law, of the light and of the background."""
    light = case.scene.light
    settings = _of_ellipses() if case.params.shape == "ellipse" else _of_widths()
    if light is not None:
        settings += [
            Setting(path=("scene", "light", name), stages=("vertex",), read_by=(method,))
            for name, method in LIT.items()
        ]

    vectors = [] if light is None else _vectors(case, light)

    def draw(program: Any, among: Bools) -> dict[str, Any]:
        codes = case.inputs.get("normals")
        found: dict[str, Any] = (
            program.render() if stage != "vertex" or codes is None else program.vertices(program.atlas(), codes)
        )
        return found

    return Numbers(case=case, port=Program, settings=settings, vectors=vectors, handed=handed, draw=draw)


def _of_widths() -> list[Setting]:
    law = [Setting(path=("params", name), stages=("vertex",), read_by=("width",)) for name in LAW]
    return law + [Setting(path=("params", name), stages=("vertex",), read_by=("clamp_width",)) for name in WIDTHS]


def _of_ellipses() -> list[Setting]:
    return [
        Setting(path=("params", name), stages=(stage,), read_by=methods, jumps=stage == "raster")
        for name, (stage, methods) in ELLIPSES.items()
    ]


def _vectors(case: Case, light: Light) -> list[Vector]:
    """The light's, and the eye that its highlights are for."""
    eye, place = case.scene.camera.eye, light.position is not None
    found = [
        Vector(
            name="light.position" if place else "light.direction",
            value=light.homogeneous[:3],
            stages=("vertex",),
            port=lit_from,
            place=place,
            others={"the eye": eye[:3]} if place else {},
        )
    ]
    if light.specular and eye[3]:
        others = {"the light": light.homogeneous[:3]} if place else {}
        found.append(
            Vector(name="eye of the highlights", value=eye[:3], stages=("vertex",), port=seen_from, others=others)
        )
    return found


def _inquiry(case: Case, device: Device, handed: Handed) -> Inquiry:
    right = Stages(model_of(case, device), handed)

    def replay(kind: type[Any], among: Bools | None, *, thorough: bool) -> Stages:
        return Stages(Model(case, device, kind, right.port.model), handed, among, right, thorough=thorough)

    return Inquiry(mutants=MUTANTS, arrays={**ARRAYS, "image": ()}, replay=replay, sampled=SAMPLED)
