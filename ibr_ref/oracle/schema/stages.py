"""The expected results in `case.json`: every array of the contract, what it means, and what stands where nothing is."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

from numpy.typing import NDArray

from ibr_ref.io import Frame
from ibr_ref.oracle.schema.base import StoredFile


class StageFile(StoredFile):
    """An array that the reference has made, and that a port may hand in under the same name."""

    name: str
    """"color", "depth", or stage.array; of an atlas stage.array.page."""
    group: str
    """The stage: the part of the name before the first dot; "image" for the final colour and depth."""
    nothing: str
    """The value where nothing is: no face, no splat, no surface."""
    kind: Literal["result", "margin"]
    """"margin": how close a decision of the reference was; ports need not hand it in."""


class Meaning(NamedTuple):
    """Of an array of the contract."""

    meaning: str
    nothing: str = "-"


IMAGE = {
    "color": Meaning("linear colour in [0, 1]", "the background"),
    "depth": Meaning("window depth: 0 at the near plane, 1 at the far plane", "1"),
}

DISPLACEMENT = {
    "vertex.clip": Meaning("corners of all drawn faces in clip space: polygons, then faces, then a, b, c, d"),
    "vertex.patch": Meaning("the same in patch space (u, v, h)"),
    "raster.face": Meaning("0 base, 1 u=0, 2 u=1, 3 v=0, 4 v=1, 5 top", "-1"),
    "raster.patch_id": Meaning("index of the polygon in the scene", "-1"),
    "raster.patch": Meaning("the fragment's point on its face, in patch space", "NaN"),
    "march.linear_index": Meaning("i, step at which the linear search stopped", "-1; also where it stopped nowhere"),
    "march.hit_index": Meaning("k, lattice index of the hit, t = k / (N 2^M)", "-1; also where discarded"),
    "march.hit": Meaning("(u, v, h) of the hit", "NaN; also where discarded"),
    "march.height_before": Meaning("a, the height map at linear step i - 1; 0 where discarded", "NaN"),
    "march.steep": Meaning("whether h - a > delta", "false"),
    "march.margin": Meaning("smallest abs(h - H) compared, without h = 0 and h = 1; inf if none is left", "NaN"),
    "march.domain_margin": Meaning(
        "smallest distance in (u, v) of a tested sample from the border; inf without", "NaN"
    ),
    "march.steep_margin": Meaning("abs(h - a - delta)", "NaN"),
    "shade.albedo": Meaning("colour or facade map at the hit", "NaN; also where discarded"),
    "shade.normal": Meaning("unit normal in world space", "NaN; also where discarded"),
    "shade.lit": Meaning("not in self-shadow", "false"),
    "shade.lit_margin": Meaning("smallest abs(h + bias - H) of the shadow's samples; inf without samples", "NaN"),
    "shade.axis_margin": Meaning("how clearly a facade's wall faces u or v; inf without a facade", "NaN"),
    "shade.facing_margin": Meaning("abs(n.l)", "NaN"),
    "resolve.margin": Meaning(
        "distance in window depth to the nearest other kept fragment; inf if there is none", "NaN"
    ),
}

SPLATTING = {
    "atlas.rects": Meaning("page, x, y, width, height of each image"),
    "atlas.color": Meaning("colours; 0 off the mask", "0"),
    "atlas.depth": Meaning("metric depth along the view axis", "0"),
    "atlas.normal": Meaning("world-space normal, floor(127 n + 128.5)", "(0, 0, 0)"),
    "vertex.window": Meaning("window x and y of every point, in order of (image, row, column)", "NaN where dropped"),
    "vertex.depth": Meaning("window depth", "NaN where dropped"),
    "vertex.width": Meaning("W_s, clamped, pixels", "0 where dropped"),
    "vertex.color": Meaning("lit colour; without a light, the stored one"),
    "vertex.source": Meaning("image, row, column"),
    "raster.splat": Meaning("the winning point", "-1"),
    "raster.depth": Meaning("its window depth", "1"),
    "raster.overdraw": Meaning("how many splats cover the pixel", "0"),
    "raster.margin": Meaning("second-smallest minus smallest depth of those; inf with fewer than two", "inf"),
}

SHADOWS = {
    "maps.positions": Meaning("the object's offsets for the nine maps, [j, i] = (x_i, y_j)"),
    "maps.depths": Meaning('the caster\'s depths in the nine maps; only with interpolation = "projective"'),
    "maps.image": Meaning("the nine maps: coverage, or window depth", "0; of depths 1"),
    "controls": Meaning("control points (u, v) in [0, 1]^2 of the map"),
    "warp.cell": Meaning("cell of the positions that holds the object, x first"),
    "warp.fraction": Meaning("s and t in the cell"),
    "warp.shares": Meaning('projective s of the two rows, and t; only with interpolation = "projective"'),
    "warp.row_grids": Meaning("lerps of G00 and G10, and of G01 and G11, by s, or by the rows' shares"),
    "warp.rows": Meaning("top and bottom, each a mix of two warped maps", "0; of depths 1"),
    "warp.grid": Meaning("lerp of the row grids by t, or by its share"),
    "warp.image": Meaning("the map that is projected", "0; of depths 1"),
    "project.coord": Meaning("(s, t, r), t downwards, r clamped to [0, 1]", "0"),
    "project.shadow": Meaning("0 lit to 1", "0"),
    "project.margin": Meaning("distance of a comparison of depths from its other outcome; inf without one", "inf"),
    "project.texel_margin": Meaning("distance to the next texel's edge, in texels, on the nearer axis", "inf"),
    "accumulate.shadow": Meaning("the sum of all light samples, each times 1/N", "0"),
}
"""With more than one light sample every warp.* and project.* array has a leading axis of samples."""

CONTRACTS = {"displacement": DISPLACEMENT, "splatting": SPLATTING, "shadows": SHADOWS}
"""What is known of the stages of each method; the methods' own documentation says more."""


def flat(stages: dict[str, Any]) -> dict[str, NDArray[Any]]:
    """Stages of several arrays as several arrays: "atlas.color.0", "atlas.color.1" and so on."""
    arrays: dict[str, NDArray[Any]] = {}
    for name, stage in stages.items():
        if isinstance(stage, tuple):
            arrays.update({f"{name}.{page}": array for page, array in enumerate(stage)})
        else:
            arrays[name] = stage
    return arrays


def expected(frame: Frame) -> dict[str, NDArray[Any]]:
    """All arrays of a frame by the names under which they are written and handed in."""
    return {"color": frame.color, "depth": frame.depth, **flat(frame.stages)}


def describe_stages(method: str, frame: Frame) -> tuple[StageFile, ...]:
    """The expected arrays as a document."""
    return tuple(_stage(method, name, array) for name, array in expected(frame).items())


def _stage(method: str, name: str, array: NDArray[Any]) -> StageFile:
    parts = name.split(".")
    known = {**IMAGE, **CONTRACTS[method]}
    meaning = known[name] if name in known else known[".".join(parts[:-1])]
    dtype: Any = array.dtype.name
    return StageFile(
        name=name,
        group="image" if name in IMAGE else parts[0],
        file=f"expected/{name}.npy",
        png="expected/color.png" if name == "color" else None,
        dtype=dtype,
        shape=array.shape,
        meaning=meaning.meaning,
        nothing=meaning.nothing,
        kind="margin" if parts[-1].endswith("margin") else "result",
    )
