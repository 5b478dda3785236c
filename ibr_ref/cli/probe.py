"""`ibr-ref probe`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from ibr_ref.oracle.cases import Case
    from ibr_ref.oracle.probe import Measured

EXAMPLES = """
Examples:

    ibr-ref export probe probes && ibr-ref draw probe drawn --with glsl

    ibr-ref probe probes drawn --out device.json

    ibr-ref check cases drawn --device device.json
"""


def command(
    case: Annotated[
        Path, typer.Argument(metavar="DIR", help="What `ibr-ref export probe DIR` wrote, or a case of it.")
    ],
    drawn: Annotated[Path, typer.Argument(metavar="DRAWN", help="What the port drew of it, of all a folder for each.")],
    out: Annotated[Path, typer.Option(help="The file for `--device`.")] = Path("device.json"),
) -> None:
    """Measure a device by what a port drew of the probes on it, and write its numbers for `check --device`.

    The profile is what port.json declares, else gl.
    """
    from ibr_ref import io
    from ibr_ref.io.outputs import atomic
    from ibr_ref.oracle import choice
    from ibr_ref.oracle.probe import Measured

    io.check_writable(out)
    many = choice.is_many(str(case))
    found, profile, seen = Measured(), "gl", 0
    for each in choice.chosen([str(case)]):
        drawing = drawn / each.name if many else drawn
        if many and not drawing.exists():
            typer.echo(f"{each.name}: no drawing: {drawing} is not there")
            continue
        measured, declared = _measured(each.make(), drawing)
        found, profile, seen = found | measured, declared or profile, seen + 1
    if not seen:
        raise ValueError(f"{drawn}: found no drawing, allowed: a folder with one for each case of {case}")
    with atomic(out) as file:
        file.write((json.dumps({"profile": profile, **found.numbers}, indent=2) + "\n").encode())
    for name, why in found.why.items():
        typer.echo(f"{name}: {found.numbers[name]}, measured ({why})" if name in found.numbers else f"{name}: {why}")
    for name, why in found.faults.items():
        typer.echo(f"fault of the driver: {name}: {why}")
    typer.echo(f"{', '.join(found.assumed)}: assumed, as {profile} grants them")


def _measured(given: Case, drawing: Path) -> tuple[Measured, str | None]:
    """What a drawing says, and the profile that the port declares."""
    from ibr_ref import oracle
    from ibr_ref.oracle.probe import PROBES
    from ibr_ref.scene import checks

    if given.name not in PROBES:
        raise checks.reject("case", given.name, "what `ibr-ref export probe DIR` wrote")
    submission = oracle.load_submission(drawing, given)
    if submission.problems:
        raise ValueError(f"{drawing}: {submission.problems[0]}")
    return PROBES[given.name].open().measure(given, submission.handed), submission.declaration.profile
