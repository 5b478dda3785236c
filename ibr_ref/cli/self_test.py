"""The tables of `ibr-ref check --self-test`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import typer

from ibr_ref.cli.tables import show
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from rich.table import Table

    from ibr_ref.oracle.self_test import MutantResult, VariantResult

MUTANT_KINDS = ("easy", "typical", "adversarial")
"""Cases on which mutants are tried; variants are on all. The real-sized ones would take an hour."""


def run(method: str | None) -> int:
    """Print both tables and the totals; the exit code: 0 if no variant is accused and no mutant unexpectedly survives."""
    from ibr_ref.oracle import self_test
    from ibr_ref.scene import checks

    if method is not None:
        checks.choice("method", method, self_test.tried())
    methods = self_test.tried() if method is None else (method,)
    variants: list[VariantResult] = []
    mutants: list[MutantResult] = []
    with progress(self_test.size(methods)) as step:
        for name in methods:
            for variant in self_test.try_variants(name):
                step(f"{name}: variant {variant.name}")
                variants.append(variant)
            for mutant in self_test.try_mutants(name, kinds=MUTANT_KINDS):
                step(f"{name}: mutant {mutant.mutant.name}")
                mutants.append(mutant)
    show(_variant_table(variants))
    show(_mutant_table(mutants))
    for name in methods:
        typer.echo(_totals(name, variants, mutants))
    accused = any(variant.accused for variant in variants)
    survived = any(mutant.case is None and not mutant.mutant.survives for mutant in mutants)
    return int(accused or survived)


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
