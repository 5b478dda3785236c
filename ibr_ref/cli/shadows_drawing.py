"""What `ibr-ref render shadows` draws, in one of three ways, and what it reports of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from ibr_ref.io import Frame
    from ibr_ref.shadows import Maps, Params, Scene, SoftParams


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """How a scene, or an ensemble, is drawn."""

    render: Callable[..., Frame]
    """render(scene, keep, rows=...): with stages or without."""
    report: Callable[[Frame], list[str]]
    """Of a frame with stages."""


def one(scene: Scene, params: Params, maps: Maps | None) -> Drawing:
    """One caster under one light; where no good maps were found standard error says so."""
    from ibr_ref import shadows
    from ibr_ref.cli.shadows_report import poor_line, report_lines, soft_report_line

    poor = None if maps is None else poor_line(maps)
    if poor:
        typer.echo(poor, err=True)
    return Drawing(
        render=lambda scene, keep, **rows: shadows.render(scene, params, maps=maps, stages=keep, **rows),
        report=lambda frame: (
            [soft_report_line(scene, frame)] if params.method == "pcss" else report_lines(scene, params, frame, maps)
        ),
    )


def soft(scene: Scene, params: SoftParams, in_bands: bool) -> Drawing:
    """The same with another soft shadow. Raises BadParameter for one in bands."""
    from ibr_ref import shadows
    from ibr_ref.cli.shadows_report import soft_report_line

    if in_bands:
        raise typer.BadParameter(
            f"--method {params.method}: found beside a TIFF, which is drawn band by band, allowed: beside a picture that is "
            "drawn at once, .png, .jpg or .exr (what it softens depends on all of it)"
        )
    return Drawing(
        render=lambda scene, keep: shadows.render_soft(scene, params, stages=keep),
        report=lambda frame: [soft_report_line(scene, frame)],
    )
