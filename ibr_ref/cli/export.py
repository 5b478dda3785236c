"""`ibr-ref export`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ibr_ref.progress import progress

EXAMPLES = """
Examples:

    ibr-ref export --list

    ibr-ref export displacement-box box

    ibr-ref export all cases

    ibr-ref export "displacement-*" cases

    ibr-ref export --schema > case.schema.json
"""


def command(
    case: Annotated[
        str | None,
        typer.Argument(
            metavar="CASE",
            help="A case's name, `all`, a pattern of names, or a folder of one's own: a case's or of cases.",
            show_default=False,
        ),
    ] = None,
    folder: Annotated[
        Path | None,
        typer.Argument(metavar="DIR", help="Made; of several a folder in it for each case.", show_default=False),
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="Print all cases: name, kind, and what each tries.")] = False,
    schema: Annotated[bool, typer.Option("--schema", help="Print the JSON Schema of case.json.")] = False,
    force: Annotated[
        bool, typer.Option("--force", help="Replace the export of another case, and whatever lies in its folder.")
    ] = False,
) -> None:
    """Write a case for ports: the scene, its inputs, and what is expected, readable in any language.

    A folder that holds an export of the same case is replaced; nothing is ever half-written.
    """
    if list_ or schema:
        return _print_schema() if schema else _print_list()
    if case is None or folder is None:
        raise typer.BadParameter("found no CASE and DIR, allowed: both, or --list, or --schema")
    _export(case, folder, force)
    return None


def _print_schema() -> None:
    from ibr_ref.oracle.schema import schema_text

    typer.echo(schema_text(), nl=False)


def _print_list() -> None:
    from ibr_ref.oracle import cases

    names = cases.names()
    width = max(map(len, names), default=0)
    lines = []
    with progress(len(names)) as step:  # each is made for it, which compiles kernels the first time
        for name in names:
            step(name)
            case = cases.build(name)
            lines.append(f"{name:{width}}  {case.kind:11}  {case.about}")
    typer.echo("\n".join(lines))


def _export(word: str, folder: Path, force: bool) -> None:
    from ibr_ref.oracle import choice, files

    choices = choice.chosen([word])
    many = choice.is_many(word)
    with progress(len(choices)) as step:
        for each in choices:
            step(each.name)
            files.export(each.make(), folder / each.name if many else folder, force=force)
