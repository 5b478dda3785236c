"""`ibr-ref bench`: times of whole frames, beside the papers' figures."""

from __future__ import annotations

from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref import methods
from ibr_ref.cli import json_output, options
from ibr_ref.cli.tables import show

EXAMPLES = """
Examples:

    ibr-ref bench

    ibr-ref bench displacement --repeat 50 --json times.json

    ibr-ref bench splatting --msr breakdancers
"""


BENCHES = {method.name: method.bench for method in methods.records() if method.bench is not None}

if TYPE_CHECKING:
    Method = str
else:
    Method = options.choices("Method", ("all", *BENCHES), "What is measured.")
ALL = Method("all")


def command(
    method: Annotated[Method, typer.Argument(help="The method to measure.")] = ALL,
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
    for name in BENCHES if method == ALL else (method,):
        for what, rows, table in BENCHES[name].open().measured(repeat, msr):
            figures[what] = rows
            show(table, error=aside)
    json_output.write(json, dumps(figures, indent=2))
