"""`ibr-ref bench`: times of whole frames, beside the papers' figures."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from ibr_ref.bench import displacement, shadows, splatting, splatting_quality

EXAMPLES = """
Examples:

    ibr-ref bench

    ibr-ref bench displacement --repeat 50 --json times.json

    ibr-ref bench splatting --msr breakdancers
"""


class Method(StrEnum):
    """What is measured."""

    all = "all"
    displacement = "displacement"
    splatting = "splatting"
    shadows = "shadows"


def command(
    method: Annotated[Method, typer.Argument(help="The method to measure.")] = Method.all,
    repeat: Annotated[
        int, typer.Option(min=1, max=1000, help="Frames of each kind; the best and the median count.")
    ] = 20,
    msr: Annotated[
        Path | None,
        typer.Option(help="splatting: a folder of MSR 3D Video with cameras 0 and 1; without, pictures by formula."),
    ] = None,
    json: Annotated[Path | None, typer.Option(help="Also write the figures as JSON.")] = None,
) -> None:
    """Time whole frames with warm kernels, beside the figures that the papers give for their hardware.

    With --msr also the quality of the splatted views, against the photographs.
    """
    from rich.console import Console

    console = Console()
    figures: dict[str, list[dict[str, Any]]] = {}
    if method in (Method.all, Method.displacement):
        figures["displacement"] = displacement.times(repeat)
        console.print(displacement.table(figures["displacement"]))
    if method in (Method.all, Method.splatting):
        figures["splatting"] = splatting.times(repeat, msr)
        console.print(splatting.table(figures["splatting"]))
        if msr is not None:
            figures["splatting_quality"] = splatting_quality.views(msr)
            console.print(splatting_quality.table(figures["splatting_quality"]))
    if method in (Method.all, Method.shadows):
        figures["shadows"] = shadows.times(repeat)
        console.print(shadows.table(figures["shadows"]))
    if json is not None:
        _write(json, figures)


def _write(path: Path, figures: dict[str, list[dict[str, Any]]]) -> None:
    import json

    from ibr_ref.io.files import atomic

    with atomic(path) as file:
        file.write(json.dumps(figures, indent=2).encode() + b"\n")
