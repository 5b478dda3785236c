"""`ibr-ref method`."""

from __future__ import annotations

from typing import Annotated

import typer

from ibr_ref import pages

EXAMPLES = """
Examples:

    ibr-ref method displacement

    ibr-ref method conventions | less
"""


def command(
    name: Annotated[
        str, typer.Argument(metavar="|".join(pages.names()), help="A method, or what all share.", show_default=False)
    ],
) -> None:
    """Print what a method does: formulas, stages, every array, ties, and what the paper leaves open.

    Rendered on a terminal, plain Markdown in a pipe. The README of an exported case has the part that the case needs.
    """
    if name not in pages.names():
        raise typer.BadParameter(f"found {name!r}, allowed: {' | '.join(pages.names())}")
    text = pages.page(name)
    from rich.console import Console

    console = Console()
    if not console.is_terminal:
        typer.echo(text, nl=False)
        return
    from rich.markdown import Markdown

    console.print(Markdown(text))
