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
from ibr_ref.cli.judging import Finding, lines, worst
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.oracle.choice import Choice
    from ibr_ref.oracle.declaration import Declaration
    from ibr_ref.oracle.examination import Examination
    from ibr_ref.oracle.report import Facts
    from ibr_ref.ports.drawing import Drawer

EXAMPLES = """
Examples:

    ibr-ref conformance --with glsl --out my-gpu

    ibr-ref conformance "shadows-*" --with wgsl --adapter vulkan

    ibr-ref conformance all --with webgl --out my-browser

    ibr-ref conformance --compare my-gpu/conformance.json my-browser/conformance.json --out both
"""
SMALL = "small"
"""Every built-in case but those of real size."""
NUMBERS = "conformance.json"
"""The run's file in its folder."""


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
    compare: Annotated[
        tuple[Path, Path] | None,
        typer.Option(metavar="A.json B.json", help="Two runs beside each other instead.", show_default=False),
    ] = None,
) -> None:
    """Measure this machine's device, draw cases with a sample port, and judge whether its driver is right.

    A case is judged by the device that was measured, and where that one does not explain it, by any. One that the sample
    port has no code for is left out. Exit code 0: all pass, 1: a case fails, 2: a case cannot be judged.
    """
    from ibr_ref.io.outputs import make_folder
    from ibr_ref.ports.drawing import SAMPLES

    if compare is not None:
        from ibr_ref.cli.compared_runs import run

        run(*compare, out)
        return
    choices = _chosen(case)
    if out is not None:
        make_folder(out)
    with closing(SAMPLES[with_.value](adapter)) as drawer, tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) if out is None else out
        facts = _facts(drawer, folder)
        findings, left_out = _judged(drawer, choices, folder, facts)
    if not findings:
        raise ValueError("; ".join(left_out))
    if out is not None:
        _write(facts, findings, out)
    typer.echo("\n".join([*_words(facts), *left_out, *lines(findings, len(findings))]))
    raise typer.Exit(worst(findings))


def _chosen(word: str) -> list[Choice]:
    from ibr_ref.oracle import choice

    if word != SMALL:
        return choice.chosen([word])
    return [each for each in choice.chosen([choice.ALL]) if each.make().kind != "real-sized"]


def _facts(drawer: Drawer, folder: Path) -> Facts:
    """What the probes say of the device."""
    from ibr_ref import oracle
    from ibr_ref.oracle import files
    from ibr_ref.oracle.probe import PROBES, Measured
    from ibr_ref.oracle.report import Facts

    measured, unmeasured = Measured(faults=drawer.faults), dict[str, str]()
    for name, room in PROBES.items():
        probe = room.open()
        case, drawing = probe.probe_case(), folder / "drawn" / name
        files.export(case, folder / "cases" / name, force=True)
        try:
            drawer.into(folder / "cases" / name, drawing)
            measured |= probe.measure(case, oracle.load_submission(drawing, case).handed)
        except ValueError as error:
            unmeasured[name] = str(error)
    return Facts(drawer.name, drawer.words, dict(drawer.declares), measured, unmeasured)


def _words(facts: Facts) -> list[str]:
    """The device, in lines."""
    measured = ", ".join(f"{name} {value}" for name, value in facts.measured.numbers.items())
    return [
        f"{facts.port} on {facts.words}",
        f"measured: {measured or 'nothing'}",
        *(f"probe not drawn: {name}: {why}" for name, why in facts.unmeasured.items()),
        *(f"fault of the driver: {name}: {why}" for name, _, why in facts.faults),
    ]


def _judged(drawer: Drawer, choices: Sequence[Choice], folder: Path, facts: Facts) -> tuple[list[Finding], list[str]]:
    """Export, draw and check each; and lines on those that the port does not draw."""
    from ibr_ref.oracle import files
    from ibr_ref.oracle.declaration import of_fields
    from ibr_ref.ports.drawing import NOT_PORTED

    device = of_fields({**facts.declares, **facts.measured.numbers})
    findings, left_out = list[Finding](), list[str]()
    with progress(len(choices)) as step:
        for each in choices:
            step(each.name)
            drawing = folder / "drawn" / each.name
            started, case = time.perf_counter(), each.make()
            files.export(case, folder / "cases" / each.name, force=True)
            try:
                drawer.into(folder / "cases" / each.name, drawing)
            except ValueError as error:
                if NOT_PORTED in str(error):
                    left_out.append(f"left out: {error}")
                else:
                    findings.append(_refused(each.name, str(error)))
                continue
            found = _examined(case, drawing, device)
            findings.append(Finding(each.name, found.verdict, found, time.perf_counter() - started))
    return findings, left_out


def _examined(case: Any, drawing: Path, device: Declaration) -> Examination:
    """By a device, or by any where that one does not explain all."""
    from ibr_ref import oracle
    from ibr_ref.oracle.declaration import ANY

    submission = oracle.load_submission(drawing, case)
    found = oracle.check(case, submission, profile=device, name_causes=False)
    return found if not found.verdict.outcome.exit_code else oracle.check(case, submission, profile=ANY)


def _refused(name: str, reason: str) -> Finding:
    from ibr_ref.oracle.findings import Outcome
    from ibr_ref.oracle.verdict import Verdict

    return Finding(name, Verdict(outcome=Outcome.INCONCLUSIVE, case=name, method="", reasons=(reason,)), None, 0.0)


def _row(finding: Finding) -> dict[str, Any]:
    """A case's, in the file."""
    verdict = finding.verdict
    wrong = next((stage for stage in verdict.stages if stage.wrong), None)
    return {
        "case": finding.name,
        "outcome": str(verdict.outcome),
        "device": verdict.device,
        "undecided": verdict.undecided_share,
        "first_wrong_stage": verdict.first_wrong_stage,
        "wrong": wrong.wrong if wrong is not None else 0,
        "elements": wrong.elements if wrong is not None else 0,
        "reasons": list(verdict.reasons),
        "seconds": round(finding.seconds, 2),
    }


def _write(facts: Facts, findings: Sequence[Finding], out: Path) -> None:
    """index.html and conformance.json, and a report of each case that does not pass."""
    from ibr_ref import oracle
    from ibr_ref.io.outputs import atomic
    from ibr_ref.oracle.report import entry, write_run

    entries = []
    for finding in findings:
        shown = finding.examination if finding.verdict.outcome.exit_code else None
        entries.append(entry(finding.name, finding.verdict, finding.seconds, shown))
        if shown is not None:
            oracle.write_report(shown, out / f"{finding.name}.html")
    document = {
        "port": facts.port,
        "device": facts.words,
        "declares": facts.declares,
        "measured": dict(facts.measured.numbers),
        "why": dict(facts.measured.why),
        "assumed": facts.measured.assumed,
        "faults": dict(facts.measured.faults),
        "unmeasured": dict(facts.unmeasured),
        "cases": [_row(finding) for finding in findings],
    }
    with atomic(out / NUMBERS) as file:
        file.write((json.dumps(document, indent=2) + "\n").encode())
    write_run(entries, out, facts)
