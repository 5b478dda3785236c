"""`ibr-ref conformance`."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli.draw import Port
from ibr_ref.cli.judging import Finding, Judging, worst
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.oracle.choice import Choice
    from ibr_ref.ports.drawing import Drawer

EXAMPLES = """
Examples:

    ibr-ref conformance --with glsl --out my-gpu

    ibr-ref conformance "shadows-*" --with wgsl --adapter vulkan

    ibr-ref conformance all --with webgl --out my-browser
"""
SMALL = "small"
"""Every built-in case but those of real size."""


def command(
    case: Annotated[
        str,
        typer.Argument(metavar="CASE", help="Which: names and folders as in `ibr-ref draw`, `all`, or the small ones."),
    ] = SMALL,
    with_: Annotated[
        Port, typer.Option("--with", help="OpenGL 4.5, WebGPU, WebGL 2 in a headless browser, or NumPy in float32.")
    ] = Port.glsl,
    adapter: Annotated[
        str | None,
        typer.Option(help="As in `ibr-ref draw`: which of several drivers, adapters or browsers.", show_default=False),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="A folder for index.html, conformance.json, a report of each case that fails, cases and drawings.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Draw cases with a sample port on this machine's device, and judge whether its driver is right.

    Exit code 0: all pass, 1: a case fails, 2: a case cannot be judged.
    """
    from ibr_ref.io.outputs import make_folder
    from ibr_ref.ports.drawing import SAMPLES

    choices = _chosen(case)
    if out is not None:
        make_folder(out)
    with closing(SAMPLES[with_.value](adapter)) as drawer, tempfile.TemporaryDirectory() as temporary:
        findings = _judged(drawer, choices, Path(temporary) if out is None else out)
    if out is not None:
        _write(drawer, findings, out)
    typer.echo("\n".join([f"{drawer.name} on {drawer.words}", *_lines(findings)]))
    raise typer.Exit(worst(findings))


def _chosen(word: str) -> list[Choice]:
    from ibr_ref.oracle import choice

    if word != SMALL:
        return choice.chosen([word])
    return [each for each in choice.chosen([choice.ALL]) if each.make().kind != "real-sized"]


def _judged(drawer: Drawer, choices: Sequence[Choice], folder: Path) -> list[Finding]:
    """Export, draw and check each."""
    from ibr_ref.oracle import files

    findings = []
    with progress(len(choices)) as step:
        for each in choices:
            step(each.name)
            case, drawing = folder / "cases" / each.name, folder / "drawn" / each.name
            started = time.perf_counter()
            files.export(each.make(), case, force=True)
            try:
                drawer.into(case, drawing)
            except ValueError as error:
                findings.append(_refused(each.name, str(error)))
                continue
            ((_, judge),) = Judging(str(case), drawing, None).jobs()
            found = judge()
            findings.append(Finding(each.name, found.verdict, found.examination, time.perf_counter() - started))
    return findings


def _refused(name: str, reason: str) -> Finding:
    from ibr_ref.oracle.findings import Outcome
    from ibr_ref.oracle.verdict import Verdict

    return Finding(name, Verdict(outcome=Outcome.INCONCLUSIVE, case=name, method="", reasons=(reason,)), None, 0.0)


def _summary(finding: Finding) -> dict[str, Any]:
    """A case's row."""
    verdict = finding.verdict
    wrong = next((stage for stage in verdict.stages if stage.wrong), None)
    blamed = f"{wrong.wrong:,} of {wrong.elements:,} elements, {', '.join(wrong.blamed)}" if wrong is not None else ""
    return {
        "case": finding.name,
        "outcome": str(verdict.outcome),
        "device": verdict.device,
        "undecided": verdict.undecided_share,
        "first_wrong_stage": verdict.first_wrong_stage,
        "wrong": blamed,
        "reasons": list(verdict.reasons),
        "seconds": round(finding.seconds, 2),
    }


def _lines(findings: Sequence[Finding]) -> list[str]:
    rows = [_summary(finding) for finding in findings]
    width = max(len(row["case"]) for row in rows)
    lines = []
    for row in rows:
        said = row["reasons"] or ([f"{row['first_wrong_stage']}: {row['wrong']}"] if row["first_wrong_stage"] else [])
        lines.append(f"{row['outcome']:12}  {row['case']:{width}}  {said[0] if said else 'on ' + row['device']}")
    outcomes = [row["outcome"] for row in rows]
    counts = ", ".join(f"{outcomes.count(outcome)} {outcome}" for outcome in sorted(set(outcomes)))
    return [*lines, f"{len(rows)} cases: {counts}."]


def _write(drawer: Drawer, findings: Sequence[Finding], out: Path) -> None:
    """index.html and conformance.json, and a report of each case that does not pass."""
    from ibr_ref import oracle
    from ibr_ref.io.outputs import atomic

    rows = [_summary(finding) for finding in findings]
    facts = {"port": drawer.name, "device": drawer.words, "declares": dict(drawer.declares)}
    reports = {}
    for finding in findings:
        if finding.examination is not None and finding.verdict.outcome.exit_code:
            reports[finding.name] = f"{finding.name}.html"
            oracle.write_report(finding.examination, out / reports[finding.name])
    with atomic(out / "conformance.json") as file:
        file.write((json.dumps({**facts, "cases": rows}, indent=2) + "\n").encode())
    with atomic(out / "index.html") as file:
        file.write(_page(facts, rows, reports).encode())


def _page(facts: dict[str, Any], rows: Sequence[dict[str, Any]], reports: dict[str, str]) -> str:
    """One page: the device, and a line a case."""
    from importlib import resources

    from jinja2 import Environment

    source = resources.files("ibr_ref.cli").joinpath("conformance.html").read_text("utf-8")
    return (
        Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
        .from_string(source)
        .render(facts=facts, rows=rows, reports=reports, passed=sum(row["outcome"] == "PASS" for row in rows))
    )
