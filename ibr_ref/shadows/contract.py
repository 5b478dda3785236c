"""The arrays of shadows by image warping: the one table of names, shapes, dtypes, "nothing" and meaning."""

from __future__ import annotations

from ibr_ref.contract import StageArray

_INF = float("inf")
_WARP = 'method="warp"'
_SOFT = 'method="pcss"'
_PACED = 'method="warp", interpolation="projective"'

STAGES: dict[str, StageArray] = {
    "maps.positions": StageArray(
        shape=(3, 3, 2),
        dtype="float64",
        meaning="the object's offsets for the nine maps, [j, i] = (x_i, y_j)",
        only=_WARP,
    ),
    "maps.depths": StageArray(
        shape=(3, 3), dtype="float64", meaning="depth of the caster's middle in the nine maps", only=_PACED
    ),
    "maps.image": StageArray(
        shape=(3, 3, "S", "S"),
        dtype="float64",
        meaning="the nine maps: coverage, or window depth",
        nothing=0.0,
        remark="; of depths 1",
        only=_WARP,
    ),
    "controls": StageArray(
        shape=(3, 3, "R", "C", 2), dtype="float64", meaning="control points (u, v) in [0, 1]^2 of the map", only=_WARP
    ),
    "warp.cell": StageArray(
        shape=(2,),
        dtype="int32",
        meaning="cell of the positions that holds the object, x first",
        per_sample=True,
        only=_WARP,
    ),
    "warp.fraction": StageArray(
        shape=(2,), dtype="float64", meaning="s and t in the cell", per_sample=True, only=_WARP
    ),
    "warp.shares": StageArray(
        shape=(3,),
        dtype="float64",
        meaning="s of the upper row, s of the lower row, and t, as the pace has them",
        per_sample=True,
        only=_PACED,
    ),
    "warp.row_grids": StageArray(
        shape=(2, "R", "C", 2),
        dtype="float64",
        meaning="lerp(G00, G10, s) and lerp(G01, G11, s)",
        per_sample=True,
        only=_WARP,
    ),
    "warp.rows": StageArray(
        shape=(2, "S", "S"),
        dtype="float64",
        meaning="top and bottom, each a mix of two warped maps",
        nothing=0.0,
        remark="; of depths 1",
        per_sample=True,
        only=_WARP,
    ),
    "warp.grid": StageArray(
        shape=("R", "C", 2), dtype="float64", meaning="lerp of the row grids by t", per_sample=True, only=_WARP
    ),
    "warp.image": StageArray(
        shape=("S", "S"),
        dtype="float64",
        meaning="the map that is projected",
        nothing=0.0,
        remark="; of depths 1",
        per_sample=True,
    ),
    "project.coord": StageArray(
        shape=("H", "W", 3),
        dtype="float64",
        meaning='(s, t, r), t downwards, r clamped to [0, 1]; "pcss": r the distance from the light\'s plane',
        nothing=0.0,
        per_sample=True,
    ),
    "project.shadow": StageArray(shape=("H", "W"), dtype="float64", meaning="0 lit to 1", nothing=0.0, per_sample=True),
    "project.blocker": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="mean distance of the blockers that were found from the light's plane; 0 without any",
        nothing=0.0,
        per_sample=True,
        only=_SOFT,
    ),
    "project.penumbra": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="1/blocker - 1/r, by which the light's points are scaled on the map; 0 without a blocker",
        nothing=0.0,
        per_sample=True,
        only=_SOFT,
    ),
    "project.margin": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="distance of a comparison of depths from its other outcome; inf without one",
        nothing=_INF,
        per_sample=True,
    ),
    "project.texel_margin": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="distance to the next texel's edge, in texels, on the nearer axis",
        nothing=_INF,
        per_sample=True,
    ),
    "accumulate.shadow": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="the sum of all light samples, each times 1/N",
        nothing=0.0,
    ),
}
"""In the pipeline's order. Sizes: S texels a side of a map; R x C control points; H rows and W columns of the picture."""
