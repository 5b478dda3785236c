"""`ibr-ref reproduce`: the papers' tables and figures, measured on this machine."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ibr_ref import methods
from ibr_ref.cli import options
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.reproduce.findings import Reproduction

EXAMPLES = """
Examples:

    ibr-ref reproduce 1

    ibr-ref reproduce all --out reproduced

What is done is not done again: start it once more after an interruption, or with --again to measure anew.
"""


PAPERS = {str(method.paper): method.reproduction for method in methods.records() if method.reproduction is not None}
WHICH = ", ".join(
    f"{method.paper} {method.name} ({method.source.rpartition(' ')[0]})"
    for method in methods.records()
    if str(method.paper) in PAPERS
)

if TYPE_CHECKING:
    Paper = str
else:
    Paper = options.choices("Paper", (*PAPERS, "all"), "Which.")


def command(
    paper: Annotated[Paper, typer.Argument(help=f"{WHICH}.")],
    out: Annotated[Path, typer.Option(help="Folder of the pages, pictures and JSON.")] = Path("reproduced"),
    again: Annotated[bool, typer.Option("--again", help="Measure anew what is already there.")] = False,
) -> None:
    """Measure what a paper's tables and figures show, beside the published values."""
    wanted = list(PAPERS) if paper == "all" else [paper]
    from ibr_ref.io.outputs import make_folder

    make_folder(out)
    chosen: list[Reproduction] = [PAPERS[one].open() for one in wanted]
    with progress(sum(len(reproduction.steps) for reproduction in chosen)) as step:
        from ibr_ref.reproduce.run import run

        pages = [run(reproduction, out, again=again, step=step) for reproduction in chosen]
    for page in pages:
        typer.echo(str(page))
