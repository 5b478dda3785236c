"""The maps of `ibr-ref render shadows`: which ones, and where they are from."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.choices import CONTENTS, CONTROLS, INTERPOLATIONS, POLICIES, SHADOWED_BY, SOFT
from ibr_ref.cli import options
from ibr_ref.cli.groups import told

if TYPE_CHECKING:
    from ibr_ref.shadows import Maps, Params, Scene

    Method = str
    Policy = str
    Interpolation = str
    Content = str
    Controls = str
else:
    Method = options.choices("Method", (*SHADOWED_BY, *SOFT), "Where the shadow comes from.")
    Policy = options.choices("Policy", POLICIES, "How the maps around the object's place are warped.")
    Interpolation = options.choices("Interpolation", INTERPOLATIONS, "Pace of the control points between two maps.")
    Content = options.choices("Content", CONTENTS, "What a map holds.")
    Controls = options.choices("Controls", CONTROLS, "Placement of the control points.")
WARP, DISSOLVE, LINEAR = Method("warp"), Policy("dissolve"), Interpolation("linear")
MASK, FAST = Content("mask"), Controls("fast")


@dataclass(frozen=True, kw_only=True)
class Making:
    """Options: how the shadow is made, and of which maps."""

    method: Annotated[
        Method,
        typer.Option(
            help="Maps warped, rendered for every sample, or a grid of them; or the whole light: rays, Soler & Sillion's "
            "convolution, percentage-closer soft shadows."
        ),
    ] = WARP
    map_size: Annotated[int, typer.Option(parser=options.whole, help="Texels a side of a shadow map.")] = 512
    map_samples: Annotated[
        int, typer.Option(parser=options.whole, help="k: a texel is the coverage of k x k samples.")
    ] = 1
    rows: Annotated[int, typer.Option(parser=options.whole, help="Control points downwards.")] = 15
    columns: Annotated[int, typer.Option(parser=options.whole, help="Control points across.")] = 5
    policy: Annotated[Policy, typer.Option(help="Six warps a map, or three.")] = DISSOLVE
    interpolation: Annotated[
        Interpolation, typer.Option(help="Pace between two maps: even, as in the paper, or that of perspective.")
    ] = LINEAR
    content: Annotated[Content, typer.Option(help="Silhouettes, or depths.")] = MASK
    controls: Annotated[Controls, typer.Option(help="How the control points are placed.")] = FAST
    maps: Annotated[
        Path | None,
        typer.Option(
            help="--method warp: prepared maps are read from here, with all that they were made with, or else written here "
            "(.npz)."
        ),
    ] = None


def check_writable(making: Making) -> None:
    """Raise OSError where maps are to be written and cannot be, before they are prepared."""
    from ibr_ref import io

    if making.maps is not None and not _kept(making.maps):
        io.check_writable(making.maps)


def params(making: Making, samples: int, named: set[str]) -> tuple[Params, Maps | None]:
    """The parameters, and the maps if there is a file of them: then what was not named is what they were made with."""
    from ibr_ref import shadows

    fields = {**told(making, "controls", "maps"), "light_samples": samples}
    loaded = _loaded(making, fields, named)
    if loaded is not None:
        fields.update(loaded.made_with)
    return shadows.Params(**fields), loaded


def prepared(scene: Scene, params: Params, making: Making, within: Callable[[str, int, int], None] | None) -> Maps:
    """Maps made here, and written where a file is named."""
    from ibr_ref import shadows

    made = shadows.prepare(scene, params, controls=str(making.controls), progress=within)
    if making.maps is not None:
        made.save(making.maps)
    return made


def _kept(path: Path) -> bool:
    """Whether maps may be read from there: not from a pipe or a device, which are written to."""
    from ibr_ref.io.outputs import is_stream

    return os.path.exists(path) and not is_stream(path)  # Path.exists raises for names that are too long


def _loaded(making: Making, fields: Mapping[str, Any], named: set[str]) -> Maps | None:
    """Maps from the file if it is there; raises BadParameter for fields that were named, and are not the file's."""
    from ibr_ref import shadows

    path = making.maps
    if path is None or not _kept(path):
        return None
    maps = shadows.Maps.load(path)
    wanted = {**fields, "controls": str(making.controls)}
    for name, value in {**maps.made_with, "controls": maps.placement}.items():
        if name in named and wanted[name] != value:
            flag = "--" + name.replace("_", "-")
            raise typer.BadParameter(f"{flag}: found {wanted[name]}, allowed: {value} ({name} of {path})")
    return maps
