"""`ibr-ref check`: the verdict on a port, and the oracle's trial on itself."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ibr_ref import methods
from ibr_ref.cli import json_output
from ibr_ref.cli.groups import grouped
from ibr_ref.cli.judging import Finding, Judging, lines, worst
from ibr_ref.oracle.device import PROFILES
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.oracle.report import Entry

EXAMPLES = """
Examples:

    ibr-ref export displacement-box cases/box

    ibr-ref check cases/box my_port/box --report verdict.html

    ibr-ref check cases/box my_port/box --device vulkan --json verdict.json

    ibr-ref check cases my_port --junit verdicts.xml --report reports

    ibr-ref check cases/box my_port/box --watch

    ibr-ref check --self-test

Exit code 0: PASS, 1: FAIL, 2: INCONCLUSIVE, or the case or an option is unusable. Of many cases: 1 if any is FAIL, else 2
if any is INCONCLUSIVE.
"""

_DEVICES, _METHODS = (f"{', '.join(names[:-1])} or {names[-1]}" for names in ([*PROFILES], methods.names()))

POLL = 0.3
"""Seconds between two looks at the files that are watched."""


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """Options: where verdicts go besides the words."""

    json: Annotated[
        Path | None,
        typer.Option(
            help="Also write the verdict, of many a list, or --self-test's tables, as JSON; -: on standard output."
        ),
    ] = None
    report: Annotated[
        Path | None,
        typer.Option(
            help="Also write it as one HTML page, with pictures; of many a folder of them, with an index.html."
        ),
    ] = None
    junit: Annotated[Path | None, typer.Option(help="Also write it as JUnit XML.")] = None


@grouped
def command(
    *,
    case: Annotated[
        str | None,
        typer.Argument(
            help="Folder that `ibr-ref export` wrote, or one of such folders; a built-in case's name, `all`, or a pattern.",
            show_default=False,
        ),
    ] = None,
    port: Annotated[
        Path | None,
        typer.Argument(
            help="Folder with what the port drew: color.png or color.npy, any stages; of many cases a folder of such, each "
            "under its case's name.",
            show_default=False,
        ),
    ] = None,
    device: Annotated[
        str | None,
        typer.Option(
            help=f"{_DEVICES}; with numbers, as in gl,subpixel_bits=4; or a .json file of them. "
            "Without: port.json's, or the tightest that explains all."
        ),
    ] = None,
    outputs: Outputs,
    watch: Annotated[
        bool, typer.Option("--watch", help="Check again whenever files of the case or the port change, until Ctrl-C.")
    ] = False,
    fail_fast: Annotated[
        bool, typer.Option("--fail-fast", help="Of many cases: stop at the first that does not pass.")
    ] = False,
    self_test: Annotated[
        bool, typer.Option("--self-test", help="Try the oracle on right ports and on broken ones, and print the table.")
    ] = False,
    method: Annotated[str | None, typer.Option(help=f"--self-test: {_METHODS} alone.")] = None,
    coarse: Annotated[
        bool, typer.Option("--coarse", help="--self-test: are bugs seen on devices of fewer bits and more freedom too?")
    ] = False,
) -> None:
    """Say whether a port's pictures are right, and if not, where they first go wrong."""
    if self_test:
        from ibr_ref.cli.self_test import run, run_coarse

        raise typer.Exit((run_coarse if coarse else run)(method, outputs.json))
    if case is None or port is None:
        raise typer.BadParameter("found too few folders, allowed: CASE and PORT, or --self-test")
    judging = Judging(case, port, device)
    _check_writable(outputs, many=judging.many)
    raise typer.Exit(_watched(judging, outputs, fail_fast) if watch else _checked(judging, outputs, fail_fast))


def _checked(judging: Judging, outputs: Outputs, fail_fast: bool) -> int:
    """Judge, write, say; the exit code."""
    jobs = judging.jobs()
    findings: list[Finding] = []
    entries: list[Entry] = []
    with progress(len(jobs)) as step:
        for name, judge in jobs:
            step(name)
            findings.append(judge())
            _write_report(findings[-1], outputs.report, entries if judging.many else None)
            if fail_fast and worst(findings):
                break
    if entries and outputs.report is not None:
        from ibr_ref.oracle.report import write_run

        write_run(entries, outputs.report)
    _write(findings, outputs, many=judging.many)
    aside = json_output.is_standard_output(outputs.json)
    for finding in findings:
        if finding.warning is not None:
            typer.echo(f"ibr-ref: {finding.warning}", err=True)
    said = lines(findings, len(jobs)) if judging.many else [findings[0].verdict.words()]
    typer.echo("\n".join(said), err=aside)
    return worst(findings)


def _watched(judging: Judging, outputs: Outputs, fail_fast: bool) -> int:
    """The same until an interruption, after every change; the last exit code. What cannot be used yet is said in a line."""
    seen: object = None
    before: object = None
    code = 2
    try:
        while True:
            now = judging.signature()
            if now != seen and (seen is None or now == before):  # else somebody is still writing
                seen, code = now, _checked_or_said(judging, outputs, fail_fast)
            before = now
            time.sleep(POLL)
    except KeyboardInterrupt:
        return code


def _checked_or_said(judging: Judging, outputs: Outputs, fail_fast: bool) -> int:
    typer.echo(time.strftime("%H:%M:%S"), err=True)
    try:
        return _checked(judging, outputs, fail_fast)
    except (ValueError, OSError) as error:
        typer.echo(f"ibr-ref: {error}", err=True)
        return 2


def _check_writable(outputs: Outputs, *, many: bool) -> None:
    """Raise OSError before long work."""
    from ibr_ref import io
    from ibr_ref.io.outputs import make_folder

    json_output.check_writable(outputs.json)
    if outputs.junit is not None:
        io.check_writable(outputs.junit)
    if outputs.report is not None:
        if many:
            make_folder(outputs.report)
        else:
            io.check_writable(outputs.report)


def _write_report(finding: Finding, report: Path | None, entries: list[Entry] | None) -> None:
    """The page of a case; of many it is one in a folder, and an entry of the run's."""
    if report is None:
        return
    from ibr_ref import oracle
    from ibr_ref.oracle.report import entry

    if entries is not None:
        entries.append(entry(finding.name, finding.verdict, finding.seconds, finding.examination))
    if finding.examination is not None:
        oracle.write_report(finding.examination, report if entries is None else report / f"{finding.name}.html")


def _write(findings: Sequence[Finding], outputs: Outputs, *, many: bool) -> None:
    texts = [finding.verdict.model_dump_json(indent=2) for finding in findings]
    json_output.write(outputs.json, "[\n" + ",\n".join(texts) + "\n]" if many else texts[0])
    if outputs.junit is not None:
        from ibr_ref.io.outputs import atomic
        from ibr_ref.oracle.report import junit

        with atomic(outputs.junit) as file:
            file.write(junit((finding.verdict, finding.seconds) for finding in findings))
