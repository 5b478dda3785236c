"""The tables of `ibr-ref check --self-test`."""

from __future__ import annotations

import json as encoder
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from ibr_ref.cli import json_output
from ibr_ref.cli.tables import show
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from rich.table import Table

    from ibr_ref.oracle.self_test import MutantResult, VariantResult
    from ibr_ref.oracle.sight import Sight

MUTANT_KINDS = ("easy", "typical", "adversarial")
"""Cases on which mutants are tried, and sight; variants are on all. The real-sized ones would take an hour."""

LEAST_COARSE = 0.9
"""Share of the bugs that a desktop's device shows that a coarser one has to show."""


def run(method: str | None, json: Path | None = None) -> int:
    """Print the tables and the totals; the exit code: 0 if no variant is accused and no mutant unexpectedly survives."""
    from ibr_ref.oracle import self_test
    from ibr_ref.oracle.sight import sights
    from ibr_ref.scene import checks

    if method is not None:
        checks.choice("method", method, self_test.tried())
    json_output.check_writable(json)
    methods = self_test.tried() if method is None else (method,)
    variants: list[VariantResult] = []
    mutants: list[MutantResult] = []
    seen: list[Sight] = []
    with progress(self_test.size(methods)) as step:
        for name in methods:
            for variant in self_test.try_variants(name):
                step(f"{name}: variant {variant.name}")
                variants.append(variant)
            for mutant in self_test.try_mutants(name, kinds=MUTANT_KINDS):
                step(f"{name}: mutant {mutant.mutant.name}")
                mutants.append(mutant)
            seen += sights(name, kinds=MUTANT_KINDS)
    json_output.write(json, _as_json(variants, mutants, seen))
    if not json_output.is_standard_output(json):
        show(_variant_table(variants))
        show(_mutant_table(mutants))
        show(_sight_table(seen))
    for name in methods:
        typer.echo(_totals(name, variants, mutants), err=json_output.is_standard_output(json))
    accused = any(variant.accused for variant in variants)
    survived = any(mutant.case is None and not mutant.mutant.survives for mutant in mutants)
    return int(accused or survived)


def run_coarse(method: str | None, json: Path | None = None) -> int:
    """Print how many bugs that a desktop's device shows are seen on coarser ones; the exit code: 0 if nine in ten are."""
    from ibr_ref.oracle import self_test
    from ibr_ref.oracle.coarse import CoarseResult, try_coarse
    from ibr_ref.scene import checks

    if method is not None:
        checks.choice("method", method, self_test.tried())
    json_output.check_writable(json)
    results: list[CoarseResult] = []
    methods = self_test.tried() if method is None else (method,)
    with progress(sum(len(self_test.plain_port(name).MUTANTS) for name in methods)) as step:
        for name in methods:
            for result in try_coarse(name, kinds=MUTANT_KINDS):
                step(f"{name}: mutant {result.mutant.name}")
                results.append(result)
    rows = [{"method": r.method, "mutant": r.mutant.name, "fine": r.fine, "found": dict(r.found)} for r in results]
    json_output.write(json, encoder.dumps(rows, indent=2))
    enough = True
    for name in methods:
        shown = [r for r in results if r.method == name and r.fine]
        for device in dict.fromkeys(device for r in shown for device in r.found):
            found = sum(r.found[device] is not None for r in shown)
            enough &= found >= LEAST_COARSE * len(shown)
            typer.echo(f"{name}: {found} of {len(shown)} on {device}", err=json_output.is_standard_output(json))
    return int(not enough)


def _as_json(variants: Sequence[VariantResult], mutants: Sequence[MutantResult], seen: Sequence[Sight]) -> str:
    """The numbers of all tables."""
    broken = [
        {**{n: v for n, v in vars(m).items() if n != "mutant"}, "name": m.mutant.name, "its_stage": m.mutant.stage}
        for m in mutants
    ]
    tables = {"right": [asdict(v) for v in variants], "broken": broken, "sight": [asdict(s) for s in seen]}
    return encoder.dumps(tables, indent=2)


def _sight_table(results: Sequence[Sight]) -> Table:
    from rich.table import Table

    columns = ("hits", "colour: picture", "+ depth", "+ stages", "depth: + colour", "+ stages")
    title = "Sight: % of hit pixels at which a random colour, a depth off by 1e-3, is called right"
    table = Table("method", "case", "profile", *columns, title=title)
    for each in results:
        shares = (
            each.color_of_picture,
            each.color_beside_depth,
            each.color_beside_stages,
            each.depth_beside_color,
            each.depth_beside_stages,
        )
        percents = [f"{100.0 * share:.2f}" for share in shares]
        table.add_row(each.method, each.case, each.profile, f"{each.hits:,}", *percents)
    return table


def _variant_table(results: Sequence[VariantResult]) -> Table:
    from rich.table import Table

    table = Table("method", "legal variant", "profile", "cases", "pixels", "verdict", title="Right ports")
    for result in results:
        verdict = "[red]accused: " + ", ".join(result.accused) if result.accused else "passed"
        table.add_row(result.method, result.name, result.profile, str(result.cases), f"{result.pixels:,}", verdict)
    return table


def _mutant_table(results: Sequence[MutantResult]) -> Table:
    from rich.table import Table

    table = Table(
        "method", "mutant", "its stage", "stage named", "wrong there", "by the image alone", title="Broken ports"
    )
    for result in results:
        mutant = result.mutant
        named = result.stage or f"[yellow]survives[/]: {mutant.survives or 'unexpectedly'}"
        if result.stage and not result.stage_right:
            named = f"[yellow]{named}"
        image = (
            f"{result.image_pixels:,} pixels" if result.image_case else f"not seen: {mutant.hidden or 'unexpectedly'}"
        )
        table.add_row(result.method, mutant.name, mutant.stage, named, f"{result.elements:,}", image)
    return table


def _totals(method: str, variants: Sequence[VariantResult], mutants: Sequence[MutantResult]) -> str:
    mine = [m for m in mutants if m.method == method]
    right = [v for v in variants if v.method == method]
    killed = sum(m.case is not None for m in mine)
    named, seen = sum(m.stage_right for m in mine), sum(m.image_case is not None for m in mine)
    return (
        f"{method}: {sum(not v.accused for v in right)} of {len(right)} right ports passed; {killed} of {len(mine)} broken "
        f"ones killed with stages, in {named} of them the stage was right; {seen} by the image alone."
    )
