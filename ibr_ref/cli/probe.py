"""`ibr-ref probe`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

EXAMPLES = """
Examples:

    ibr-ref export probe probe && ibr-ref draw probe drawn/probe --with glsl

    ibr-ref probe probe drawn/probe --out device.json

    ibr-ref check cases drawn --device device.json
"""


def command(
    case: Annotated[Path, typer.Argument(metavar="DIR", help="What `ibr-ref export probe DIR` wrote.")],
    drawn: Annotated[Path, typer.Argument(metavar="DRAWN", help="What the port drew of it.")],
    out: Annotated[Path, typer.Option(help="The file for `--device`.")] = Path("device.json"),
) -> None:
    """Measure a device by what a port of displacement mapping drew on it, and write its numbers for `check --device`.

    The profile is what port.json declares, else gl.
    """
    from ibr_ref import io, oracle
    from ibr_ref.io.outputs import atomic
    from ibr_ref.oracle import probe
    from ibr_ref.scene import checks

    io.check_writable(out)
    given = oracle.load_case(case)
    if given.name != probe.probe_case().name:
        raise checks.reject("case", given.name, "what `ibr-ref export probe DIR` wrote")
    submission = oracle.load_submission(drawn, given)
    if submission.problems:
        raise ValueError(f"{drawn}: {submission.problems[0]}")
    found = probe.measure(given, submission.handed)
    profile = submission.declaration.profile or "gl"
    with atomic(out) as file:
        file.write((json.dumps({"profile": profile, **found.numbers}, indent=2) + "\n").encode())
    for name, value in found.numbers.items():
        typer.echo(f"{name}: {value}, measured ({found.why[name]})")
    typer.echo(f"{', '.join(found.assumed)}: assumed, as {profile} grants them")
