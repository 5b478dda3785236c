"""`--case` of `ibr-ref render`: what is rendered, as a case for ports."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

Folder = Annotated[
    Path | None,
    typer.Option(
        "--case", metavar="DIR", help="Also write what is rendered as a case for `ibr-ref check`, named as the folder."
    ),
]

WHY = "the oracle judges no others"

_LONGEST_ABOUT = 500
"""Characters of the command line."""


def check_writable(folder: Path | None) -> None:
    """Raise OSError where no case can be written, before long work."""
    if folder is not None:
        from ibr_ref.oracle.files import check_replaceable

        check_replaceable(folder, _name(folder))


def write(folder: Path | None, scene: Any, params: Any, **inputs: Any) -> None:
    """Write the case, if there is a place for it, and print how much of it each device lets be judged."""
    if folder is None:
        return
    from ibr_ref.oracle import Case, export
    from ibr_ref.oracle.power import said
    from ibr_ref.progress import progress
    from ibr_ref.scene.checks import one_line

    about = one_line(shlex.join(["ibr-ref", *sys.argv[1:]]), _LONGEST_ABOUT)
    case = Case(name=_name(folder), about=about, scene=scene, params=params, inputs=inputs)
    with progress(2) as step:
        step("how much of the case each device leaves open")
        shares = case.undecided
        step("writing the case")
        export(case, folder)
    typer.echo(f"{folder}: {said(shares)}.")


def _name(folder: Path) -> str:
    """The folder's, as names of cases may be."""
    return re.sub(r"[^A-Za-z0-9._-]+", "-", folder.resolve().name).lstrip("._-")[:64] or "own"
