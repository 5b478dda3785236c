"""`ibr-ref check`: the verdict on a port, and the oracle's trial on itself."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ibr_ref import methods
from ibr_ref.cli import json_output
from ibr_ref.oracle.device import PROFILES
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.oracle.examination import Examination

EXAMPLES = """
Examples:

    ibr-ref export displacement-box cases/box

    ibr-ref check cases/box my_port/box --report verdict.html

    ibr-ref check cases/box my_port/box --device vulkan --json verdict.json

    ibr-ref check --self-test

Exit code 0: PASS, 1: FAIL, 2: INCONCLUSIVE, or the case or an option is unusable.
"""

_DEVICES, _METHODS = (f"{', '.join(names[:-1])} or {names[-1]}" for names in ([*PROFILES], methods.names()))


def command(
    case: Annotated[Path | None, typer.Argument(help="Folder that `ibr-ref export` wrote.", show_default=False)] = None,
    port: Annotated[
        Path | None,
        typer.Argument(help="Folder with what the port drew: color.png or color.npy, any stages.", show_default=False),
    ] = None,
    device: Annotated[
        str | None,
        typer.Option(help=f"{_DEVICES}. Without: port.json's, or the tightest that explains all."),
    ] = None,
    json: Annotated[
        Path | None,
        typer.Option(
            help="Also write the verdict (--self-test: its tables) as JSON; -: on standard output, the words on standard error."
        ),
    ] = None,
    report: Annotated[Path | None, typer.Option(help="Also write it as one HTML page, with pictures.")] = None,
    self_test: Annotated[
        bool, typer.Option("--self-test", help="Try the oracle on right ports and on broken ones, and print the table.")
    ] = False,
    method: Annotated[str | None, typer.Option(help=f"--self-test: {_METHODS} alone.")] = None,
) -> None:
    """Say whether a port's pictures are right, and if not, where they first go wrong."""
    if self_test:
        from ibr_ref.cli.self_test import run

        raise typer.Exit(run(method, json))
    if case is None or port is None:
        raise typer.BadParameter("found too few folders, allowed: CASE and PORT, or --self-test")
    examination = _examined(case, port, device, json, report)
    json_output.write(json, examination.verdict.model_dump_json(indent=2))
    typer.echo(examination.verdict.words(), err=json_output.is_standard_output(json))
    raise typer.Exit(examination.verdict.outcome.exit_code)


def _examined(case: Path, port: Path, device: str | None, json: Path | None, report: Path | None) -> Examination:
    """Read, judge, and write the page."""
    with progress(4) as step:
        step("reading the case")
        from ibr_ref import io, oracle

        json_output.check_writable(json)
        if report is not None:
            io.check_writable(report)
        loaded = oracle.load_case(case)
        step("reading what the port drew")
        submission = oracle.load_submission(port, loaded)
        step("judging")
        examination = oracle.check(loaded, submission, profile=device)
        if report is not None:
            step("writing the report")
            oracle.write_report(examination, report)
    return examination
