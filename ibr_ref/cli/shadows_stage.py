"""The stage of `ibr-ref render shadows`: its casters and its lights, one of each or several."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from ibr_ref.choices import UP
from ibr_ref.cli import options

if TYPE_CHECKING:
    from ibr_ref.models import StageLight
    from ibr_ref.scene import Mesh
    from ibr_ref.shadows import Ensemble

Value = TypeVar("Value")


if TYPE_CHECKING:
    Up = str
else:
    Up = options.choices("Up", UP, "Axis of the mesh that points up.")
UpAxis = Annotated[Up | None, typer.Option(help="Axis of the mesh that is up. Without: by its format.")]


@dataclass(frozen=True, kw_only=True)
class Stage:
    """Options: what stands where, the lights, and their samples."""

    caster: Annotated[
        list[Path] | None,
        typer.Option(
            "--caster",
            help="A mesh that moves: OBJ, PLY, STL, glTF, Bézier patches. Once for each. Without: a horse.",
        ),
    ] = None
    up: UpAxis = None
    offset: Annotated[
        list[options.Pair] | None,
        typer.Option(
            "--offset",
            parser=options.pair,
            metavar="X,Y",
            help="Where it stands, -0.6 to 0.6 each; once for each caster. Without: 0,0.",
        ),
    ] = None
    samples: Annotated[
        int, typer.Option(parser=options.whole, help="Samples of the light: 1 (a hard shadow), 5 or 9.")
    ] = 1
    light: Annotated[
        list[options.Vector] | None,
        typer.Option(
            "--light",
            parser=options.vector,
            metavar="X,Y,Z",
            help="Where a light is; its maps fit. Once for each light. Without: -1,-1.2,5.",
        ),
    ] = None
    light_target: Annotated[
        list[options.Vector] | None,
        typer.Option(
            "--light-target",
            parser=options.vector,
            metavar="X,Y,Z",
            help="Point that the light looks at; once for all lights, or for each. Without: 0,0,0.",
        ),
    ] = None
    light_size: Annotated[
        list[options.Pair] | None,
        typer.Option(
            "--light-size",
            parser=options.one_or_two,
            metavar="A[,B]",
            help="Half the side of the light, or half of both, along x and y, for more than one sample; once for all "
            "lights, or for each. The mesh's largest extent is 1. Without: 0.12.",
        ),
    ] = None
    light_power: Annotated[
        list[float] | None,
        typer.Option(
            "--light-power",
            parser=options.number,
            metavar="P",
            help="Factor of the light; once for all lights, or for each. The light of all adds up, to at most 1. "
            "Without: 1.",
        ),
    ] = None


def ensemble(stage: Stage, **camera: Any) -> Ensemble:
    """All that is there, with z up; without a caster the horse."""
    from ibr_ref import models

    lights = _lights(stage)
    paths: list[Path | None] = [*stage.caster] if stage.caster else [None]
    meshes = [read_caster(path, stage.up) for path in paths]
    places = stage.offset or [options.Pair(0, 0)]
    if len(places) != len(meshes):
        found, count = len(stage.offset or []), len(meshes)
        raise typer.BadParameter(f"--offset: found {found}, allowed: one for each of {count} of --caster")
    return models.shadow_ensemble(meshes, offsets=places, lights=lights, **camera)


def _lights(stage: Stage) -> list[StageLight]:
    """One for each position; without any the stage's own."""
    from ibr_ref.models import StageLight

    places: list[options.Vector | None] = [*stage.light] if stage.light else [None]
    aims: list[options.Vector | None] = [*stage.light_target] if stage.light_target else [None]
    count = len(places)
    rows = zip(
        places,
        _for_each("--light-target", aims, count, "lights"),
        _for_each("--light-size", stage.light_size or [options.Pair(0.12, 0.12)], count, "lights"),
        _for_each("--light-power", stage.light_power or [1.0], count, "lights"),
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

    return models.horse() if path is None else io.read_upright(path, None if up is None else str(up))
