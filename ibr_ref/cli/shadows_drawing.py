"""What `ibr-ref render shadows` draws, in one of three ways, and what it reports of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from ibr_ref.io import Frame
    from ibr_ref.shadows import Ensemble, Maps, Params, SoftParams


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """A scene, or an ensemble, and how it is drawn."""

    scene: Any
    params: Any
    render: Callable[..., Frame]
    """render(scene, keep, rows=...): with stages or without."""
    report: Callable[[Frame], list[str]]
    """Of a frame with stages."""
    maps: Maps | None = None
    """Of one caster under one light."""


def one(ensemble: Ensemble, params: Params, maps: Maps | None) -> Drawing:
    """One caster under one light; where no good maps were found standard error says so."""
    from ibr_ref import shadows
    from ibr_ref.cli.shadows_report import poor_line, report_lines

    poor = None if maps is None else poor_line(maps)
    if poor:
        typer.echo(poor, err=True)
    scene = ensemble.scene(0, 0)
    return Drawing(
        scene=scene,
        params=params,
        render=lambda scene, keep, **rows: shadows.render(scene, params, maps=maps, stages=keep, **rows),
        report=lambda frame: report_lines(scene, params, frame, maps),
        maps=maps,
    )


def soft(ensemble: Ensemble, params: SoftParams, in_bands: bool) -> Drawing:
    """The same with another soft shadow. Raises BadParameter for one in bands."""
    from ibr_ref import shadows
    from ibr_ref.cli.shadows_report import soft_report_line

    if in_bands:
        found, allowed = (
            f"--method {params.method}: found beside a TIFF, which is drawn band by band",
            "a picture that is drawn at once",
        )
        raise typer.BadParameter(
            f"{found}, allowed: beside {allowed}, .png, .jpg or .exr (what it softens depends on all of it)"
        )
    scene = ensemble.scene(0, 0)
    return Drawing(
        scene=scene,
        params=params,
        render=lambda scene, keep: shadows.render_soft(scene, params, stages=keep),
        report=lambda frame: [soft_report_line(scene, frame)],
    )
