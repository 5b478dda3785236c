"""What each array of a port is computed from: which of its inputs are the port's own arrays, and which the case's.

Every stage is judged on the port's own arrays. An array that is not handed in is made from what it reads in turn, as far as
that is handed in, and at last from the case. Besides what stands here all stages read the case's scene and parameters: the
cameras, meshes, polygons and textures, the light, the law of the splats. Margins are what the reference knows of itself: no
stage reads them.

Two inputs are the case's and may be the port's: splatting's 8-bit normals (`atlas.normal`) and the nine maps of shadows with
their positions. The case hands them over, and a port may make its own. It may go on with either, but for all elements of an
array with one of the two; and with its own only where it hands them in: what it does not hand in is the case's.
So a picture without them is judged with the case's: any legal code in each texel would let through what is of both.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from ibr_ref.methods import named

DISPLACEMENT: dict[str, tuple[str, ...]] = {
    "vertex.clip": (),
    "vertex.patch": (),
    "raster.face": ("vertex.clip",),
    "raster.patch_id": ("vertex.clip",),
    "raster.patch": ("vertex.clip", "vertex.patch"),
    "march.linear_index": ("raster.face", "raster.patch_id", "raster.patch"),
    "march.hit_index": ("raster.face", "raster.patch_id", "raster.patch"),
    "march.hit": ("raster.face", "raster.patch_id", "raster.patch"),
    "march.height_before": ("raster.face", "raster.patch_id", "raster.patch"),
    "march.steep": ("raster.face", "raster.patch_id", "raster.patch"),
    "shade.albedo": ("raster.patch_id", "march.hit_index", "march.hit", "march.steep"),
    "shade.normal": ("raster.patch_id", "march.hit_index", "march.hit", "march.steep"),
    "shade.lit": ("raster.patch_id", "march.hit_index", "march.hit"),
    "color": ("raster.patch_id", "march.hit_index", "march.hit", "shade.albedo", "shade.normal", "shade.lit"),
    "depth": ("raster.patch_id", "march.hit_index", "march.hit"),
}

SPLATTING: dict[str, tuple[str, ...]] = {
    "atlas.rects": (),
    "atlas.color": (),
    "atlas.depth": (),
    "atlas.normal": (),
    "vertex.source": (),
    "vertex.window": ("atlas.rects", "atlas.depth"),
    "vertex.depth": ("atlas.rects", "atlas.depth"),
    "vertex.width": ("atlas.rects", "atlas.depth"),
    "vertex.color": ("atlas.rects", "atlas.color", "atlas.depth", "atlas.normal"),
    "raster.splat": ("vertex.window", "vertex.depth", "vertex.width"),
    "raster.depth": ("vertex.window", "vertex.depth", "vertex.width"),
    "raster.overdraw": ("vertex.window", "vertex.width"),
    "color": ("vertex.color", "raster.splat"),
    "depth": ("raster.splat", "raster.depth"),
}

GAUSSIANS = ("vertex.covariance", "vertex.amplitude", "vertex.distance")
ELLIPSES: dict[str, tuple[str, ...]] = {
    **{name: reads for name, reads in SPLATTING.items() if not name.startswith(("raster", "color", "depth"))},
    "vertex.covariance": ("atlas.rects", "atlas.depth", "atlas.normal"),
    "vertex.width": ("atlas.rects", "atlas.depth", "atlas.normal"),
    "vertex.amplitude": ("atlas.rects", "atlas.depth", "atlas.normal"),
    "vertex.distance": ("atlas.rects", "atlas.depth"),
    "raster.splat": ("vertex.window", "vertex.depth", "vertex.covariance"),
    "raster.depth": ("vertex.window", "vertex.depth", "vertex.covariance"),
    "raster.overdraw": ("vertex.window", "vertex.covariance"),
    "raster.weight": ("vertex.window", *GAUSSIANS, "raster.splat"),
    "raster.blended": ("vertex.window", "vertex.covariance", "vertex.distance", "raster.splat"),
    "color": ("vertex.window", *GAUSSIANS, "vertex.color", "raster.splat", "raster.weight"),
    "depth": ("raster.splat", "raster.depth"),
}
"""Of splats that are averaged."""

SHADOWS: dict[str, tuple[str, ...]] = {
    "maps.positions": (),
    "maps.depths": ("maps.positions",),
    "maps.image": ("maps.positions",),
    "controls": (),
    "warp.cell": ("maps.positions",),
    "warp.fraction": ("maps.positions",),
    "warp.shares": ("maps.depths", "warp.cell", "warp.fraction"),
    "warp.row_grids": ("controls", "warp.cell", "warp.shares"),
    "warp.rows": ("maps.image", "controls", "warp.cell", "warp.shares", "warp.row_grids"),
    "warp.grid": ("warp.shares", "warp.row_grids"),
    "warp.image": ("warp.shares", "warp.row_grids", "warp.rows", "warp.grid"),
    "depth": (),
    "project.coord": ("depth",),
    "project.blocker": ("warp.image", "depth", "project.coord"),
    "project.penumbra": ("project.coord", "project.blocker"),
    "project.shadow": ("warp.image", "depth", "project.coord", "project.blocker", "project.penumbra"),
    "accumulate.shadow": ("project.shadow",),
    "color": ("depth", "accumulate.shadow"),
}
"""`depth` says which surface a pixel shows, where the case leaves that open; its number goes into nothing."""


OF_SYSTEMS = {("splatting", "ellipse"): ELLIPSES}
"""Where a system's arrays are made of others than the method's."""


def system_of(method: str, params: Any) -> str:
    """What a case is drawn by: the value of the field that systems are chosen by; nothing where the method has one alone."""
    return str(getattr(params, named(method).judged[0], ""))


def reads_of(method: str, system: str = "") -> dict[str, tuple[str, ...]]:
    """For each array of a method, by one of its systems, the port's own arrays that it is computed from."""
    if (method, system) in OF_SYSTEMS:
        return OF_SYSTEMS[method, system]
    reads: dict[str, tuple[str, ...]] = named(method).reads.open()
    return reads


def fed(method: str, arrays: Collection[str], handed: Collection[str], system: str = "") -> tuple[str, ...]:
    """Of what was handed in, all that arrays are computed from: what they read, or what that reads where it is missing."""
    reads = reads_of(method, system)
    found: set[str] = set()
    waiting = [name for array in arrays for name in reads[array]]
    while waiting:
        name = waiting.pop()
        if name in handed:
            found.add(name)
        else:
            waiting += reads[name]
    return tuple(name for name in reads if name in found)
