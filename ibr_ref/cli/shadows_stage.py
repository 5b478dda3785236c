"""The stage of `ibr-ref render shadows`: its casters and its lights, one of each or several."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from ibr_ref.cli import options

if TYPE_CHECKING:
    from ibr_ref.models import StageLight
    from ibr_ref.scene import Mesh
    from ibr_ref.shadows import Ensemble

Value = TypeVar("Value")


class Up(StrEnum):
    """Axis of the mesh that points up."""

    y = "y"
    z = "z"


UpAxis = Annotated[Up | None, typer.Option(help="Axis of the mesh that is up. Without: by its format.")]
Casters = Annotated[
    list[Path] | None,
    typer.Option(
        "--caster",
        help="A mesh that moves: OBJ, PLY, STL, glTF, Bézier patches. Once for each. Without: a horse.",
    ),
]
Offsets = Annotated[
    list[options.Pair] | None,
    typer.Option(
        "--offset",
        parser=options.pair,
        metavar="X,Y",
        help="Where it stands, -0.6 to 0.6 each; once for each caster. Without: 0,0.",
    ),
]
Lights = Annotated[
    list[options.Vector] | None,
    typer.Option(
        "--light",
        parser=options.vector,
        metavar="X,Y,Z",
        help="Where a light is; its maps fit. Once for each light. Without: -1,-1.2,5.",
    ),
]
LightTargets = Annotated[
    list[options.Vector] | None,
    typer.Option(
        "--light-target",
        parser=options.vector,
        metavar="X,Y,Z",
        help="Point that the light looks at; once for all lights, or for each. Without: 0,0,0.",
    ),
]
LightSizes = Annotated[
    list[options.Pair] | None,
    typer.Option(
        "--light-size",
        parser=options.one_or_two,
        metavar="A[,B]",
        help="Half the side of the light, or half of both, along x and y, for more than one sample; once for all lights, or "
        "for each. The mesh's largest extent is 1. Without: 0.12.",
    ),
]
LightPowers = Annotated[
    list[float] | None,
    typer.Option(
        "--light-power",
        parser=options.number,
        metavar="P",
        help="Factor of the light; once for all lights, or for each. The light of all adds up, to at most 1. Without: 1.",
    ),
]


def stage(
    casters: list[Path] | None,
    up: Up | None,
    offsets: list[options.Pair] | None,
    lights: list[StageLight],
    **camera: Any,
) -> Ensemble:
    """All that is there, with z up; without a caster the horse."""
    from ibr_ref import models

    paths: list[Path | None] = [*casters] if casters else [None]
    meshes = [read_caster(path, up) for path in paths]
    places = offsets or [options.Pair(0, 0)]
    if len(places) != len(meshes):
        found, count = len(offsets or []), len(meshes)
        raise typer.BadParameter(f"--offset: found {found}, allowed: one for each of {count} of --caster")
    return models.shadow_ensemble(meshes, offsets=places, lights=lights, **camera)


def stage_lights(
    positions: list[options.Vector] | None,
    targets: list[options.Vector] | None,
    sizes: list[options.Pair] | None,
    powers: list[float] | None,
) -> list[StageLight]:
    """One for each position; without any the stage's own."""
    from ibr_ref.models import StageLight

    places: list[options.Vector | None] = [*positions] if positions else [None]
    aims: list[options.Vector | None] = [*targets] if targets else [None]
    count = len(places)
    rows = zip(
        places,
        _for_each("--light-target", aims, count, "lights"),
        _for_each("--light-size", sizes or [options.Pair(0.12, 0.12)], count, "lights"),
        _for_each("--light-power", powers or [1.0], count, "lights"),
        strict=True,
    )
    return [StageLight(position=place, target=target, size=size, power=power) for place, target, size, power in rows]


def _for_each(flag: str, found: list[Value], count: int, of: str) -> list[Value]:
    """As many values as there are casters or lights: one stands for all."""
    if len(found) not in (1, count):
        raise typer.BadParameter(f"{flag}: found {len(found)}, allowed: 1, or one for each of {count} {of}")
    return found * count if len(found) == 1 else found


def read_caster(path: Path | None, up: Up | None) -> Mesh:
    """The mesh with z up; without a path the horse."""
    from ibr_ref import io, models

    return models.horse() if path is None else io.read_upright(path, None if up is None else up.value)
