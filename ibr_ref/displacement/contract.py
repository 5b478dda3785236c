"""The arrays of protruded displacement mapping: the one table of names, shapes, dtypes, "nothing" and meaning."""

from __future__ import annotations

from ibr_ref.contract import OWN, StageArray

_NAN, _INF = float("nan"), float("inf")

STAGES: dict[str, StageArray] = {
    "vertex.clip": StageArray(
        shape=("n", 4),
        dtype="float64",
        meaning="corners of all drawn faces in clip space: polygons, then faces, then a, b, c, d",
    ),
    "vertex.patch": StageArray(shape=("n", 3), dtype="float64", meaning="the same in patch space (u, v, h)"),
    "raster.face": StageArray(
        shape=("H", "W"), dtype="int32", meaning="0 base, 1 u=0, 2 u=1, 3 v=0, 4 v=1, 5 top", nothing=-1, discarded=OWN
    ),
    "raster.patch_id": StageArray(
        shape=("H", "W"), dtype="int32", meaning="index of the polygon in the scene", nothing=-1, discarded=OWN
    ),
    "raster.patch": StageArray(
        shape=("H", "W", 3),
        dtype="float64",
        meaning="the fragment's point on its face, in patch space",
        nothing=_NAN,
        discarded=OWN,
    ),
    "march.linear_index": StageArray(
        shape=("H", "W"),
        dtype="int32",
        meaning="i, step at which the linear search stopped",
        nothing=-1,
        remark="; also where it stopped nowhere",
        discarded=-1,
    ),
    "march.hit_index": StageArray(
        shape=("H", "W"),
        dtype="int32",
        meaning="k, lattice index of the hit, t = k / (N 2^M)",
        nothing=-1,
        remark="; also where discarded",
        discarded=-1,
    ),
    "march.hit": StageArray(
        shape=("H", "W", 3),
        dtype="float64",
        meaning="(u, v, h) of the hit",
        nothing=_NAN,
        remark="; also where discarded",
        discarded=_NAN,
    ),
    "march.height_before": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="a, the height map at linear step i - 1; 0 where discarded",
        nothing=_NAN,
        discarded=0.0,
    ),
    "march.steep": StageArray(
        shape=("H", "W"), dtype="bool", meaning="whether h - a > delta", nothing=False, discarded=False
    ),
    "march.margin": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="smallest abs(h - H) compared, without h = 0 and h = 1; inf if none is left",
        nothing=_NAN,
        discarded=OWN,
    ),
    "march.domain_margin": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="smallest distance in (u, v) of a tested sample from the border; inf without",
        nothing=_NAN,
        discarded=OWN,
    ),
    "march.steep_margin": StageArray(
        shape=("H", "W"), dtype="float64", meaning="abs(h - a - delta)", nothing=_NAN, discarded=_NAN
    ),
    "march.fetches": StageArray(
        shape=("H", "W"),
        dtype="int32",
        meaning="texture fetches of the search",
        nothing=0,
        only="method: a compared system with a search of its own",
        discarded=OWN,
    ),
    "shade.albedo": StageArray(
        shape=("H", "W", 3),
        dtype="float64",
        meaning="colour or facade map at the hit",
        nothing=_NAN,
        remark="; also where discarded",
        discarded=_NAN,
    ),
    "shade.normal": StageArray(
        shape=("H", "W", 3),
        dtype="float64",
        meaning="unit normal in world space",
        nothing=_NAN,
        remark="; also where discarded",
        discarded=_NAN,
    ),
    "shade.lit": StageArray(
        shape=("H", "W"), dtype="bool", meaning="not in self-shadow", nothing=False, discarded=False
    ),
    "shade.lit_margin": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="smallest abs(h + bias - H) of the shadow's samples; inf without samples",
        nothing=_NAN,
        discarded=_NAN,
    ),
    "shade.axis_margin": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="how clearly a facade's wall faces u or v; inf without a facade",
        nothing=_NAN,
        discarded=_NAN,
    ),
    "shade.facing_margin": StageArray(
        shape=("H", "W"), dtype="float64", meaning="abs(n.l)", nothing=_NAN, discarded=_NAN
    ),
    "resolve.margin": StageArray(
        shape=("H", "W"),
        dtype="float64",
        meaning="distance in window depth to the nearest other kept fragment; inf if there is none",
        nothing=_NAN,
        discarded=_INF,
    ),
}
"""In the pipeline's order. Sizes: n = 4 corners of each drawn face; H rows and W columns of the picture."""

FRAGMENT_FIELDS: dict[str, str] = {
    name.partition(".")[2]: name
    for name, entry in STAGES.items()
    if name.startswith(("raster.", "march.", "shade.")) and not entry.only
}
"""What a pixel holds of its fragment: names without the stage, and with it."""
