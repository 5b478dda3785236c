"""The known bugs that explain a wrong stage of shadows, or a picture by itself."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.faults.shadows import MUTANTS
from ibr_ref.oracle.faults.shadows.hidden import GIVEN
from ibr_ref.oracle.faults.shadows.vectors import lit_from, turned_to
from ibr_ref.oracle.faults.taken import Setting
from ibr_ref.oracle.faults.vectors import Vector
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement
from ibr_ref.oracle.programs.shadows import Port as Program
from ibr_ref.oracle.referees.causes import Numbers, explained
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.stages import ARRAYS, PARTS, PIXELS, Replay, part_of
from ibr_ref.oracle.referees.suspects import Inquiry

FIRST = {stage: part for part, (stage, _, _) in reversed(PARTS.items())}
"""Of each stage the first part: from there on its bugs are tried."""

_SUSPECTS = tuple(replace(mutant, stage=FIRST[mutant.stage]) for mutant in MUTANTS)


def causes(right: Inputs, handed: Handed, wrong: Judgement) -> Explanation | None:
    """The bugs that explain every element of a part of a stage.

    Bugs of the stage first, then, where none of them does, those that may hide in it; of a picture those of all stages. And
    the numbers of the case that do, or that the port's results look like.
    """
    inquiry, numbers, part = _inquiry(right), _numbers(right, handed), part_of(wrong.part or wrong.stage)
    if part == "image":
        return explained(inquiry, numbers, replace(wrong, stage=part), [*FIRST.values()])
    hidden = {FIRST[PARTS[each][0]] for each in inquiry.hidden_in(part, handed)}
    return explained(inquiry, numbers, replace(wrong, stage=part), (FIRST[wrong.stage],), hidden - {FIRST[wrong.stage]})


def recognizes(right: Inputs, wrong: Judgement, cause: str) -> bool:
    """Whether the bug of that name explains every element of a part of a stage, or of a picture."""
    part = replace(wrong, stage=part_of(wrong.part or wrong.stage))
    return _numbers(right, right.picture or right.handed).recognizes(_inquiry(right), part, cause)


def _numbers(right: Inputs, handed: Handed) -> Numbers:
    """Those of maps, of comparisons and of the light."""
    case = right.case
    mask, maps = case.params.content == "mask", "warp" if right.direct else "maps"
    frustum, given = ("caster_clip", "moved_clip"), right.picture and not right.direct
    settings = [Setting(path=("scene", "ambient"), stages=("resolve",), read_by=("ambient",))]
    if not mask:
        settings.append(
            Setting(path=("params", "bias"), stages=("project",), read_by=("biased",), jumps=not case.params.pcf)
        )
    if not given:  # a picture is made with the maps that the case hands over
        settings += [Setting(path=("params", "map_samples"), stages=(maps,), read_by=("share",))] if mask else []
    if right.direct and right.picture:  # else the arrays' shapes say it
        settings += [
            Setting(path=("params", "map_size"), stages=(maps,), read_by=frustum),
            Setting(path=("params", "light_samples"), stages=(maps,), read_by=("sample_places",), among=(1, 5, 9)),
        ]
    light = ("near", "far") if not mask else ()
    settings += [
        Setting(path=("scene", "light", name), stages=(maps, "project"), read_by=frustum)
        for name in (*light, "vertical_fov")
    ]
    settings = [replace(each, stages=tuple(FIRST[stage] for stage in each.stages)) for each in settings]
    return Numbers(case=case, port=Program, settings=settings, vectors=_vectors(case, maps), handed=handed)


def _vectors(case: Case, maps: str) -> list[Vector]:
    """The light's, everywhere or in colours alone, and the eye that normals are turned to."""
    value, eye = np.asarray(case.scene.light.position, np.float64), case.scene.camera.eye
    setting = Setting(
        path=("scene", "light", "position"), stages=(), read_by=("light_centre", "caster_clip", "moved_clip")
    )

    def allows(other: Floats) -> bool:
        """Some scenes have the caster on one side of the light."""
        try:
            setting.port(Program, other)(case.scene, case.params, Policy(), case.inputs)
        except ValueError:
            return False
        return True

    found = [
        Vector(
            name="light.position",
            value=value,
            stages=(FIRST[maps], FIRST["project"]),
            port=setting.port,
            allows=allows,
        ),
        Vector(
            name="light.position of colours",
            value=value,
            stages=(FIRST["resolve"],),
            port=lit_from,
            others={"the eye": eye[:3]},
        ),
    ]
    if eye[3]:
        of_normals = {"the light": value}
        found.append(
            Vector(name="eye of normals", value=eye[:3], stages=(FIRST["resolve"],), port=turned_to, others=of_normals)
        )
    return found


def _inquiry(right: Inputs) -> Inquiry:
    def replay(kind: type[Any], among: Bools | None, *, thorough: bool) -> Replay:
        return Replay(replace(right, kind=kind, among=among, right=right, thorough=thorough))

    sampled: Collection[str] = PIXELS
    # A picture is made with the maps that the case hands over.
    suspects = [m for m in _SUSPECTS if m.applies(right.case.system) and not (right.picture and m.hidden == GIVEN)]
    return Inquiry(mutants=suspects, arrays=ARRAYS, replay=replay, sampled=sampled)
