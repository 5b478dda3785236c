"""`ibr-ref draw`."""

from __future__ import annotations

import tempfile
from contextlib import closing
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ibr_ref.progress import progress

EXAMPLES = """
Examples:

    ibr-ref draw cases/box drawn/box --with glsl

    ibr-ref draw all drawn --with wgsl --adapter vulkan

    ibr-ref draw "displacement-*" drawn --with webgl

    ibr-ref draw cases drawn --with plain && ibr-ref check cases drawn
"""


class Port(StrEnum):
    """A sample port."""

    glsl = "glsl"
    wgsl = "wgsl"
    webgl = "webgl"
    plain = "plain"


def command(
    case: Annotated[
        str,
        typer.Argument(
            metavar="CASE",
            help="An exported case's folder or one of several, a built-in case's name, a pattern, or `all`.",
        ),
    ],
    folder: Annotated[
        Path, typer.Argument(metavar="OUT", help="Made; of several cases a folder in it for each.", show_default=False)
    ],
    with_: Annotated[
        Port,
        typer.Option(
            "--with",
            help="OpenGL 4.5, WebGPU, WebGL 2 in a headless browser, or NumPy in float32.",
            show_default=False,
        ),
    ],
    adapter: Annotated[
        str | None,
        typer.Option(
            help="glsl: a driver of Mesa, such as zink; wgsl: words of an adapter's name, such as vulkan; webgl: a browser.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Draw cases with a sample port, which reads the case's folder alone, for `ibr-ref check`."""
    from ibr_ref.oracle import choice, files
    from ibr_ref.ports.drawing import SAMPLES

    choices, many = choice.chosen([case]), choice.is_many(case)
    drawer = SAMPLES[with_.value](adapter)
    refused = []
    with closing(drawer), progress(len(choices)) as step, tempfile.TemporaryDirectory() as made:
        for each in choices:
            step(each.name)
            given = each.folder
            if given is None:
                given = Path(made) / each.name
                files.export(each.make(), given)
            try:
                drawer.into(given, folder / each.name if many else folder)
            except ValueError as error:
                if not many:
                    raise
                refused.append(str(error))
    typer.echo(f"{len(choices) - len(refused)} of {len(choices)} drawn in {drawer.name} on {drawer.words}")
    if refused:
        raise ValueError("; ".join(refused))
