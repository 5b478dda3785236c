"""The known bugs that explain a wrong stage, or a picture by itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ibr_ref.array_types import Bools
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.faults.displacement.vectors import lit_from, seen_from
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.faults.taken import Setting
from ibr_ref.oracle.faults.vectors import Vector
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement
from ibr_ref.oracle.programs.displacement import Port as Program
from ibr_ref.oracle.programs.displacement.raster import Raster
from ibr_ref.oracle.programs.displacement.vertex import Vertex
from ibr_ref.oracle.programs.program import EACH, overridden
from ibr_ref.oracle.referees.causes import EVIDENCE, Numbers, explained
from ibr_ref.oracle.referees.displacement.likely import LIKE, PARTLY, likely
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.replay import ARRAYS, Port
from ibr_ref.oracle.referees.displacement.stages import SAMPLED, Stages
from ibr_ref.oracle.referees.suspects import Inquiry
from ibr_ref.searches import SEARCHES

FACES = frozenset(dir(Vertex)) | frozenset(dir(Raster))
"""What vertex processing and rasterization call: a program that changes none of it has the right one's fragments."""
NUMBERS = ("linear_steps", "binary_steps", "min_steps", "max_steps", "distance_layers", "lod_bias", "steep_threshold")
"""Parameters of searches; the last is a bound."""
CORNERS = 3
"""Wrong vertices from which on a number is believed: each has seven, and none of them jumps."""
LIT = ("ambient", "diffuse", "specular", "exponent")
"""Numbers of the light."""


def causes(case: Case, device: Device, handed: Handed, wrong: Judgement) -> Explanation | None:
    """The bugs that explain every element of a stage.

    Bugs of the stage first, then, where none of them does, those that may hide in it. Of a picture those of all stages whose
    pictures are like it. And the numbers of the case that do, or that the port's results look like.
    """
    inquiry, numbers = _inquiry(case, device, handed), _numbers(case, handed, wrong.stage)
    if wrong.stage == "image":

        def near(suspects: Sequence[Mutant], *, partly: bool) -> Sequence[Mutant]:
            return likely(case, handed, wrong.wrong, suspects, PARTLY if partly else LIKE)

        return explained(inquiry, numbers, wrong, inquiry.arrays, likely=near)
    hidden = inquiry.hidden_in(wrong.stage, handed)
    if wrong.stage == "shade" and "color" in wrong.arrays:  # by the depth test another polygon's are shown
        hidden.append("resolve")
    return explained(inquiry, numbers, wrong, (wrong.stage,), hidden)


def recognizes(case: Case, device: Device, handed: Handed, wrong: Judgement, cause: str) -> bool:
    """Whether the bug of that name explains every element of a stage; one that there is not explains none."""
    return _numbers(case, handed, wrong.stage).recognizes(_inquiry(case, device, handed), wrong, cause)


def _numbers(case: Case, handed: Handed, stage: str) -> Numbers:
    """Those that the case reads."""
    reads, light = SEARCHES[case.params.method].reads, ("scene", "light")
    settings = [
        Setting(path=("params", name), stages=("march",), jumps=name == NUMBERS[-1])
        for name in NUMBERS
        if name in reads
    ]
    settings += [Setting(path=(*light, name), stages=("shade",)) for name in LIT]
    if case.params.shadow_steps:
        settings += [
            Setting(path=("params", "shadow_steps"), stages=("shade",)),
            Setting(path=("params", "shadow_bias"), stages=("shade",), jumps=True),
        ]
    if len({polygon.height_scale for polygon in case.scene.polygons}) == 1:
        path = ("scene", "polygons", EACH, "height_scale")
        settings.append(Setting(path=path, stages=("vertex",), read_by=("up",)))

    def draw(program: Any, among: Bools) -> dict[str, Any]:
        found: dict[str, Any] = program.render() if stage == "vertex" else program.render(among | program.rows(among))
        return found

    return Numbers(
        case=case,
        port=Program,
        settings=settings,
        vectors=_vectors(case),
        handed=handed,
        draw=draw,
        evidence=CORNERS if stage == "vertex" else EVIDENCE,
    )


def _vectors(case: Case) -> list[Vector]:
    """The light's, everywhere or in colours alone, and the eye that highlights are for."""
    light, eye = case.scene.light, case.scene.camera.eye
    place, value = light.position is not None, light.homogeneous[:3]
    name = "light.position" if place else "light.direction"
    setting = Setting(path=("scene", "light", name.partition(".")[2]), stages=())
    of = Vector(
        name=name,
        value=value,
        stages=("shade",),
        port=setting.port,
        place=place,
        others={"the eye": eye[:3]} if place else {},
        allows=lambda other: setting.allows(case, other),
    )
    found = [of, replace(of, name=f"{name} of colours", port=lit_from)] if case.params.shadow_steps else [of]
    if light.specular and eye[3]:
        others = {"the light": value} if place else {}
        found.append(
            Vector(name="eye of the highlights", value=eye[:3], stages=("shade",), port=seen_from, others=others)
        )
    return found


def _inquiry(case: Case, device: Device, handed: Handed) -> Inquiry:
    right = Stages(Port(model=Model(case, device), handed=handed))

    def replay(kind: type[Any], among: Bools | None, *, thorough: bool) -> Stages:
        stages = Stages(Port(model=Model(case, device, kind), handed=handed, among=among))
        if _draws_the_same_faces(kind):
            stages.take_fragments(right)
        return stages

    return Inquiry(
        mutants=[mutant for mutant in MUTANTS if mutant.applies(case.system)],
        arrays={**ARRAYS, "resolve": (), "image": ()},
        replay=replay,
        sampled=SAMPLED,
    )


def _draws_the_same_faces(kind: type[Any]) -> bool:
    """Whether nothing is changed that the fragments hang on."""
    return not overridden(kind, Program) & FACES
