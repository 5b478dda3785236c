"""`ibr-ref bench`: times of whole frames, beside the papers' figures."""

from __future__ import annotations

from enum import StrEnum
from json import dumps
from pathlib import Path
from typing import Annotated, Any

import typer

from ibr_ref.bench import displacement, shadows, splatting, splatting_quality
from ibr_ref.cli import json_output, options
from ibr_ref.cli.tables import show

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
        int, typer.Option(parser=options.repeats, help="Frames of each kind, 1 to 1000; the best and the median count.")
    ] = 20,
    msr: Annotated[
        Path | None,
        typer.Option(help="splatting: a folder of MSR 3D Video with cameras 0 and 1; without, pictures by formula."),
    ] = None,
    json: Annotated[
        Path | None,
        typer.Option(help="Also write the figures as JSON; -: on standard output, the tables on standard error."),
    ] = None,
) -> None:
    """Time whole frames with warm kernels, beside the figures that the papers give for their hardware.

    With --msr also the quality of the splatted views, against the photographs.
    """
    json_output.check_writable(json)
    aside = json_output.is_standard_output(json)
    figures: dict[str, list[dict[str, Any]]] = {}
    if method in (Method.all, Method.displacement):
        figures["displacement"] = displacement.times(repeat)
        show(displacement.table(figures["displacement"]), error=aside)
    if method in (Method.all, Method.splatting):
        figures["splatting"] = splatting.times(repeat, msr)
        show(splatting.table(figures["splatting"]), error=aside)
        if msr is not None:
            figures["splatting_quality"] = splatting_quality.views(msr)
            show(splatting_quality.table(figures["splatting_quality"]), error=aside)
    if method in (Method.all, Method.shadows):
        figures["shadows"] = shadows.times(repeat)
        show(shadows.table(figures["shadows"]), error=aside)
    json_output.write(json, dumps(figures, indent=2))
