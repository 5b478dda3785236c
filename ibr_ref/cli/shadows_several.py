"""`ibr-ref render shadows` with several casters or lights: how they are drawn, what is reported, and what is refused."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import typer

from ibr_ref.metrics import iou, soft_difference

if TYPE_CHECKING:
    from ibr_ref.cli.shadows_drawing import Drawing
    from ibr_ref.io import Frame
    from ibr_ref.shadows import Ensemble, Maps, Params


WHY = {
    "--method": "others soften the shadow of one caster under one light",
    "--maps": "the file holds the maps of one caster and one light",
    "--case": "the oracle judges no others",
}


def check_goes_with(ensemble: Ensemble, given: Mapping[str, object]) -> None:
    """Raise BadParameter for what goes with one caster and one light alone: options with their values, if given."""
    for what in (what for what, value in given.items() if value):
        counts = f"{len(ensemble.casters)} of --caster and {len(ensemble.lights)} of --light"
        allowed = "beside one of each and without --light-power"
        raise typer.BadParameter(f"{what}: found beside {counts}, allowed: {allowed} ({WHY[what.split()[0]]})")


def drawing(ensemble: Ensemble, params: Params, maps: list[list[Maps]] | None) -> Drawing:
    """All casters under all lights; where no good maps were found standard error says so."""
    from ibr_ref import shadows
    from ibr_ref.cli.shadows_drawing import Drawing

    if maps is not None:
        _say_poor(ensemble, maps)
    return Drawing(
        render=lambda scene, keep, **rows: shadows.render_ensemble(scene, params, maps=maps, stages=keep, **rows),
        report=lambda frame: _report_lines(ensemble, params, frame, maps),
    )


def say_cut(ensemble: Ensemble, params: Params) -> None:
    """What the lights' frusta do not hold, if anything."""
    from ibr_ref import shadows
    from ibr_ref.cli import emptiness

    for pair in ensemble.pairs:
        emptiness.say_cut(shadows.cut_by_light(ensemble.scene(*pair), params), ensemble.name_of(*pair))


def _say_poor(ensemble: Ensemble, maps: list[list[Maps]]) -> None:
    from ibr_ref.cli.shadows_report import poor_line

    for caster, light in ensemble.pairs:
        line = poor_line(maps[caster][light])
        if line is not None:
            print(f"{ensemble.name_of(caster, light)}{line}", file=sys.stderr)


def _report_lines(ensemble: Ensemble, params: Params, frame: Frame, maps: list[list[Maps]] | None) -> list[str]:
    """Each light's shadow beside the one whose maps are rendered for every sample."""
    from ibr_ref import shadows

    lines = []
    if maps is not None:
        lines.append(f"maps and controls: {sum(each.nbytes for row in maps for each in row):,} bytes")
    truth = shadows.render_ensemble(ensemble, replace(params, method="direct"))
    for light in range(len(ensemble.lights)):
        ours, theirs = (each.stages[f"light{light}.accumulate.shadow"] for each in (frame, truth))
        found = f"IoU {iou(ours, theirs):.3f}, mean difference {soft_difference(ours, theirs):.4f}"
        lines.append(f"shadow of light {light} in the picture: {found}")
    return lines
