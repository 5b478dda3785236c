"""`ibr-ref reproduce`: the papers' tables and figures, measured on this machine."""

from __future__ import annotations

from enum import StrEnum
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.reproduce.findings import Reproduction

EXAMPLES = """
Examples:

    ibr-ref reproduce 1

    ibr-ref reproduce all --out reproduced

What is done is not done again: start it once more after an interruption, or with --again to measure anew.
"""


class Paper(StrEnum):
    """Which."""

    one = "1"
    two = "2"
    three = "3"
    all = "all"


METHODS = {Paper.one: "displacement", Paper.two: "splatting", Paper.three: "shadows"}


def command(
    paper: Annotated[
        Paper, typer.Argument(help="1 displacement (Yoo & Han), 2 splatting (Lee & Park), 3 shadows (Kang & Ihm).")
    ],
    out: Annotated[Path, typer.Option(help="Folder of the pages, pictures and JSON.")] = Path("reproduced"),
    again: Annotated[bool, typer.Option("--again", help="Measure anew what is already there.")] = False,
) -> None:
    """Measure what a paper's tables and figures show, beside the published values."""
    wanted = list(METHODS) if paper is Paper.all else [paper]
    from ibr_ref.io.outputs import make_folder

    make_folder(out)
    chosen = [_reproduction(METHODS[one]) for one in wanted]
    with progress(sum(len(reproduction.steps) for reproduction in chosen)) as step:
        from ibr_ref.reproduce.run import run

        pages = [run(reproduction, out, again=again, step=step) for reproduction in chosen]
    for page in pages:
        typer.echo(str(page))


def _reproduction(method: str) -> Reproduction:
    found: Reproduction = import_module(f"ibr_ref.reproduce.{method}").REPRODUCTION
    return found
