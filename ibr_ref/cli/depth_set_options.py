"""Options of commands that read and write depth sets: those of `io.read_depth_set`, under its names."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.choices import CAMERA_AXES, DEPTHS_ALONG, PIXEL_CENTERS, POSES
from ibr_ref.cli import options
from ibr_ref.cli.groups import told


class Format(StrEnum):
    """Form of a folder of pictures with depth."""

    auto = "auto"
    open3d = "open3d"
    tum = "tum"
    scannet = "scannet"
    transforms = "transforms"
    colmap = "colmap"
    middlebury = "middlebury"
    folder = "folder"


if TYPE_CHECKING:
    Convention = str
    Poses = str
    Along = str
    PixelCenters = str
else:
    Convention = options.choices("Convention", CAMERA_AXES, "Axes of cameras.")
    Poses = options.choices("Poses", POSES, "Direction of poses.")
    Along = options.choices("Along", DEPTHS_ALONG, "What depths are measured along.")
    PixelCenters = options.choices("PixelCenters", PIXEL_CENTERS, "Places of pixels' centres in the intrinsics.")

Rgbd = Annotated[
    Path | None, typer.Option(help="A folder of pictures with depth, intrinsics and poses: what `--format` lists.")
]


@dataclass(frozen=True, kw_only=True)
class Set:
    """Options: a set that is read, and what its files leave open."""

    rgbd: Rgbd = None
    format_: Annotated[
        Format,
        typer.Option(
            "--format", help="--rgbd: its form (README.md in ibr_ref/io has a table); auto: told by its files."
        ),
    ] = Format.auto
    depth_scale: Annotated[
        float | None,
        typer.Option(
            parser=options.number,
            help="--rgbd: world units of a stored one, such as 0.001. Without, as with the next ones: what the format "
            "says, or an error where it leaves that open.",
        ),
    ] = None
    convention: Annotated[
        Convention | None,
        typer.Option(help="--rgbd: axes of cameras; opencv: +y down, looking down +z; opengl: +y up, looking down -z."),
    ] = None
    poses: Annotated[Poses | None, typer.Option(help="--rgbd: what the poses take to what.")] = None
    along: Annotated[
        Along | None, typer.Option(help="--rgbd: depths along the axis of view, or along the ray from the eye.")
    ] = None
    pixel_centers: Annotated[
        PixelCenters | None, typer.Option(help="--rgbd: at which places the intrinsics have the centres of pixels.")
    ] = None
    intrinsics: Annotated[
        options.Numbers | None,
        typer.Option(
            parser=options.intrinsics, metavar="FX,FY,CX,CY", help="--rgbd: pixels, of pictures whose files have none."
        ),
    ] = None
    max_time_gap: Annotated[
        float | None,
        typer.Option(parser=options.number, help="--rgbd: seconds, of what belongs together. Without: 0.02."),
    ] = None

    def says(self) -> dict[str, Any]:
        """The format, and the options of `io.read_depth_set`."""
        chosen = None if self.format_ is Format.auto else self.format_.value
        return {"format": chosen, **told(self, "rgbd", "format_")}


Pose = Annotated[
    options.Numbers | None,
    typer.Option(
        parser=options.pose,
        metavar="M11,M12,..",
        help="--rgbd: seen from there: 12 or 16 numbers, row by row, in the set's own axes and direction.",
    ),
]
DepthSet = Annotated[Path | None, typer.Option(help="Also write the references, as a folder that --rgbd reads.")]
OneDepthImage = Annotated[
    Path | None,
    typer.Option(help="Also write the picture with its depths, as a folder that `render splatting --rgbd` reads."),
]
PointCloud = Annotated[Path | None, typer.Option(help="Also write the points of the references, as a PLY file.")]
