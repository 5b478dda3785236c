"""`ibr-ref sweep shadows`."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from ibr_ref.cli import options, shadows_stage
from ibr_ref.cli.groups import grouped
from ibr_ref.cli.sweeps import shared
from ibr_ref.cli.what_goes_with_what import GIVEN, Beside, always

EXAMPLES = """
Examples:

    ibr-ref sweep shadows --over map_size=64,128,256,512 --over rows=5:15:5 --over columns=5 --views 8 --out sweep.parquet

    ibr-ref sweep shadows --caster cow.obj --over samples=1,5,9 --over method=warp,grid --bound soft=0.05 --plot frontier.png
"""


class Against(StrEnum):
    """What is true."""

    direct = "direct"


@grouped
def command(
    *,
    caster: Annotated[Path | None, typer.Option(help="The mesh that moves. Without: a horse.")] = None,
    up: shadows_stage.UpAxis = None,
    light: Annotated[
        options.Vector | None,
        typer.Option(parser=options.vector, metavar="X,Y,Z", help="Where the light is. Without: -1,-1.2,5."),
    ] = None,
    light_size: Annotated[
        options.Pair,
        typer.Option(parser=options.one_or_two, metavar="A[,B]", help="Half the side of the light, or of both sides."),
    ] = options.Pair(0.12, 0.12),
    size: shared.Size = shared.SMALL,
    views: shared.Places = 1,
    against: Annotated[
        Against, typer.Option(help="What is true: maps rendered for every sample of the light.")
    ] = Against.direct,
    wanted: shared.Wanted,
) -> None:
    """Which maps does my caster need? Every combination at every place of the caster, against maps rendered there.

    Measures: map, shadow (intersections over unions), soft (difference), bytes, milliseconds.
    """

    def make() -> tuple[Any, Any]:
        from ibr_ref import models

        mesh = shadows_stage.read_caster(caster, up)
        scene = models.shadow_stage(
            mesh, light_position=light, light_size=light_size, width=size.width, height=size.height
        )
        return scene, against.value

    shared.run("shadows", wanted, views, make)


def goes_with() -> dict[str, Beside]:
    """Beside which others each option is read."""
    return {
        **shared.goes_with(),
        **always("caster", "light", "light_size"),
        "up": Beside("the built-in horse stands", {"caster": GIVEN}),
    }
