"""`ibr-ref sweep splatting`."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli import depth_set_options, options, splatting_sources
from ibr_ref.cli.groups import grouped, told
from ibr_ref.cli.sweeps import shared
from ibr_ref.cli.what_goes_with_what import ABSENT, GIVEN, Beside, always

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ibr_ref.scene import DepthImage
    from ibr_ref.splatting import Scene

EXAMPLES = """
Examples:

    ibr-ref sweep splatting --mesh cow.obj --count 9 --over alpha=1,1.5,2 --over shape=square,disc --views 8
    --out sweep.parquet

    ibr-ref sweep splatting --over delta=0.2:1:0.1 --bound holes=0.001 --plot frontier.png

    ibr-ref sweep splatting --rgbd scene --cameras 0,2 --against pictures --seen-from 1,3 --over max_width=1:4:1
"""


class Against(StrEnum):
    """What is true."""

    nothing = "nothing"
    mesh = "mesh"
    pictures = "pictures"


@dataclass(frozen=True, kw_only=True)
class References:
    """Options: the references, and the pictures that they are compared with."""

    mesh: Annotated[
        Path | None, typer.Option(help="A mesh, of which reference images are made. Without: the built-in kettle.")
    ] = None
    count: Annotated[int, typer.Option(parser=options.whole, help="4, 9, 16 or 32 reference images of the mesh.")] = 9
    reference_size: Annotated[int, typer.Option(parser=options.whole, help="Pixels a side of a reference image.")] = 320
    rgbd: depth_set_options.Rgbd = None
    cameras: Annotated[
        options.Cameras,
        typer.Option(parser=options.cameras, metavar="I,J,..|all", help="--rgbd: the pictures that are references."),
    ] = options.Cameras((0,))
    seen_from: Annotated[
        options.Cameras | None,
        typer.Option(parser=options.cameras, metavar="I,J,..", help="--against pictures: the views."),
    ] = None


@dataclass(frozen=True, kw_only=True)
class View:
    """Options: the first view."""

    eye: Annotated[
        options.Vector | None,
        typer.Option(
            parser=options.vector, metavar="X,Y,Z", help="The eye of the first view. Without: from the front."
        ),
    ] = None
    target: Annotated[
        options.Vector | None,
        typer.Option(parser=options.vector, metavar="X,Y,Z", help="Point that it looks at. Without: the middle."),
    ] = None
    size: shared.Size = shared.SMALL


@grouped
def command(
    *,
    references: References,
    view: View,
    views: shared.Views = 1,
    against: Annotated[
        Against | None,
        typer.Option(help="What colours are compared with: the mesh, or other pictures of --rgbd. Without: the mesh."),
    ] = None,
    wanted: shared.Wanted,
) -> None:
    """Which splats do my references need? Every combination from every view: holes, overdraw, and decibels where known.

    Measures: holes, coverage, overdraw, decibels, milliseconds.
    """
    seen_from = references.seen_from
    chosen = against or (Against.nothing if references.rgbd is not None else Against.mesh)
    if chosen is Against.pictures and not seen_from:
        raise typer.BadParameter(
            "--against: found pictures without --seen-from, allowed: beside --rgbd and --seen-from"
        )
    total = len(seen_from) if chosen is Against.pictures and seen_from else views
    shared.run("splatting", wanted, total, lambda: _scene(references, view, chosen))


def _scene(references: References, view: View, against: Against) -> tuple[Scene, Any]:
    """The scene, and what is true of it."""
    from ibr_ref import io, models, splatting

    rgbd = references.rgbd
    truth: Any = None
    if rgbd is not None:
        images: Sequence[DepthImage] = io.read_depth_set(rgbd, views=references.cameras or None)
        truth = io.read_depth_set(rgbd, views=references.seen_from) if against is Against.pictures else None
    else:
        solid = models.kettle() if references.mesh is None else io.read_mesh(references.mesh)
        images = models.depth_rig(solid, references.count, size=references.reference_size)
        truth = solid if against is Against.mesh else None
    seen = splatting_sources.Seen(**told(view))
    camera = splatting_sources.view_of(images, seen, None, None)
    return splatting.Scene(images=images, camera=camera, light=None, background=(1.0, 1.0, 1.0)), truth


def goes_with() -> dict[str, Beside]:
    """Beside which others each option is read."""
    pictures = {"rgbd": GIVEN, "against": "pictures"}
    own = Beside("pictures have their own cameras", {"seen_from": ABSENT})
    return {
        **shared.goes_with(),
        **dict.fromkeys(("eye", "target", "size", "views"), own),
        "mesh": Beside("there is one source of references", {"rgbd": ABSENT}),
        "rgbd": Beside("there is one source of references", {"mesh": ABSENT}),
        **{
            name: Beside("reference images are made of a mesh", {"rgbd": ABSENT})
            for name in ("count", "reference_size")
        },
        "cameras": Beside("it is about pictures with depth", {"rgbd": GIVEN}),
        "seen_from": Beside("it names pictures to compare with", pictures),
        "against": Beside(
            "a mesh is known where references are made of one, pictures where they are of a set",
            {"against": "nothing"},
            {"against": "mesh", "rgbd": ABSENT},
            pictures,
        ),
        **always("over"),
    }
