"""The arrays of the splatting of depth images: the one table of names, shapes, dtypes, "nothing" and meaning."""

from __future__ import annotations

from ibr_ref.contract import OWN, StageArray

_NAN, _INF = float("nan"), float("inf")
_ELLIPSE = 'shape="ellipse"'

STAGES: dict[str, StageArray] = {
    "atlas.rects": StageArray(shape=("N", 5), dtype="int32", meaning="page, x, y, width, height of each image"),
    "atlas.color": StageArray(
        shape=("h", "w", 3), dtype="float64", meaning="colours; 0 off the mask", nothing=0.0, paged=True
    ),
    "atlas.depth": StageArray(
        shape=("h", "w"), dtype="float64", meaning="metric depth along the view axis", nothing=0.0, paged=True
    ),
    "atlas.normal": StageArray(
        shape=("h", "w", 3),
        dtype="uint8",
        meaning="world-space normal, floor(127 n + 128.5)",
        nothing=(0, 0, 0),
        paged=True,
    ),
    "vertex.window": StageArray(
        shape=("V", 2),
        dtype="float64",
        meaning="window x and y of every point, in order of (image, row, column)",
        remark="NaN where dropped",
        discarded=_NAN,
    ),
    "vertex.depth": StageArray(
        shape=("V",), dtype="float64", meaning="window depth", remark="NaN where dropped", discarded=_NAN
    ),
    "vertex.width": StageArray(
        shape=("V",),
        dtype="float64",
        meaning="W_s, clamped, or the larger side of an ellipse's box, pixels",
        remark="0 where dropped",
        discarded=0.0,
    ),
    "vertex.color": StageArray(
        shape=("V", 3), dtype="float64", meaning="lit colour; without a light, the stored one", discarded=OWN
    ),
    "vertex.source": StageArray(shape=("V", 3), dtype="int32", meaning="image, row, column", discarded=OWN),
    "vertex.covariance": StageArray(
        shape=("V", 3),
        dtype="float64",
        meaning="xx, xy, yy of the Gaussian in the window, square pixels",
        remark="NaN where dropped",
        discarded=_NAN,
        only=_ELLIPSE,
    ),
    "vertex.amplitude": StageArray(
        shape=("V",),
        dtype="float64",
        meaning="its weight at the centre, in (0, 1]",
        remark="NaN where dropped",
        discarded=_NAN,
        only=_ELLIPSE,
    ),
    "vertex.distance": StageArray(
        shape=("V",),
        dtype="float64",
        meaning="along the view axis, of which the depth tolerance is a share",
        remark="NaN where dropped",
        discarded=_NAN,
        only=_ELLIPSE,
    ),
    "raster.splat": StageArray(shape=("H", "W"), dtype="int32", meaning="the winning point", nothing=-1),
    "raster.depth": StageArray(shape=("H", "W"), dtype="float64", meaning="its window depth", nothing=1.0),
    "raster.overdraw": StageArray(
        shape=("H", "W"), dtype="int32", meaning="how many splats cover the pixel", nothing=0
    ),
    "raster.margin": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="second-smallest minus smallest depth of those; inf with fewer than two",
        nothing=_INF,
    ),
    "raster.weight": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="sum of the weights that are averaged",
        nothing=0.0,
        only=_ELLIPSE,
    ),
    "raster.blended": StageArray(
        shape=("H", "W"), dtype="int32", meaning="how many splats these are", nothing=0, only=_ELLIPSE
    ),
}
"""In the pipeline's order. Sizes: N images; h x w a page of the atlas; V points; H rows and W columns of the picture."""
