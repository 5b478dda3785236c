"""`ibr-ref conformance --compare`: two runs beside each other."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import typer

LARGEST = 2**24
"""Bytes of a run's file."""
PAGE = "compared.html"
_FACTS = ("port", "device", "declares", "measured", "assumed", "faults", "unmeasured")


def run(a: Path, b: Path, out: Path | None) -> None:
    """Say and write what differs. Raises OSError or ValueError for what is no run's file."""
    from ibr_ref.io.outputs import atomic, make_folder

    runs = [_read(path) for path in (a, b)]
    facts = [(name, *(_said(each[name]) for each in runs)) for name in _FACTS]
    by_case = [{row["case"]: row for row in each["cases"]} for each in runs]
    names = dict.fromkeys(name for rows in by_case for name in rows)
    cases = [(name, *(_verdict(rows.get(name)) for rows in by_case)) for name in names]
    different = [row for row in cases if row[1].split(",")[0] != row[2].split(",")[0]]
    if out is not None:
        from ibr_ref.oracle.report.page import asset, template

        make_folder(out)
        with atomic(out / PAGE) as file:
            page = template("compared.html").render(
                titles=(str(a), str(b)), facts=facts, cases=cases, different=len(different), style=asset("page.css")
            )
            file.write(page.encode())
    for name, here, there in [*facts[1:], *different]:
        if here != there:
            typer.echo(f"{name}: {here or 'nothing'} | {there or 'nothing'}")
    typer.echo(f"{len(cases)} cases: {len(different)} with another verdict.")


def _read(path: Path) -> dict[str, Any]:
    from ibr_ref.io.files import contents, naming

    data = contents(path)
    with naming(path):
        try:
            found = json.loads(data) if len(data) <= LARGEST else None
        except (ValueError, RecursionError):
            found = None
        if not isinstance(found, dict) or not {*_FACTS, "cases"} <= {*found} or not isinstance(found["cases"], list):
            raise ValueError("found no run, allowed: a conformance.json that `ibr-ref conformance --out DIR` wrote")
        return found


def _said(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {each}" for name, each in value.items())
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def _verdict(row: dict[str, Any] | None) -> str:
    """A case's, in words."""
    if row is None:
        return "not drawn"
    if row["reasons"]:
        return f"{row['outcome']}, {row['reasons'][0]}"
    said = row["outcome"] if not row["first_wrong_stage"] else f"{row['outcome']} in {row['first_wrong_stage']}"
    share = f", {100 * row['undecided']:.2f} % undecided" if row["undecided"] is not None else ""
    return f"{said}, on {row['device']}{share}"
