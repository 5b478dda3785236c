"""Where a port of splatting draws its splats, and how small: single points at places that are on no raster.

From the port's own windows and widths, and the columns and rows that each splat covers, follows by how much all of them lie
beside their points: a splat from c - w/2 to c + w/2 covers the centres between, and each border that is seen leaves an
interval of a pixel for the offset. Splats below a pixel mostly cover no centre; where all of them cover one they are drawn
larger than they are. A picture in bytes shows which of its neighbours a colour between two of them is stored as.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.probe.measured import Measured
from ibr_ref.scene import Camera, DepthImage, checks
from ibr_ref.splatting import Params, Scene

NEEDED = ("vertex.window", "vertex.width", "raster.splat")
"""What has to be handed in."""
GRID = (12, 9)
"""Columns and rows of points."""
APART = 16
"""Pixels between them."""
STEP = 1.0 / 256.0
"""Between the offsets that are tried."""
FARTHEST = 1.0
"""Pixels: of them."""
AGREE = 0.9
"""Share of the borders that an offset has to explain."""
RASTER = 1.0 / 16.0
"""The coarsest step that a standard allows: sprites that lie farther from their points are at no legal place."""
SMALL = 0.8
"""Pixels: splats below it cover less than two thirds of the centres."""
FEW = 12
"""So many of them have to be there."""
TIE = 1e-3
"""Bytes: nearer to the middle between two of them a colour may be stored as either."""
COLORS = 100
"""Channels of points whose bytes have to be seen."""


def probe_case() -> Case:
    """Points before a camera of parallel lines of sight, as wide as they are near: from .4 to 6 pixels."""
    random = np.random.default_rng(5)
    columns, rows = GRID
    size: dict[str, Any] = {"view_height": float(rows), "near": 0.5, "far": 30.0}
    source = Camera.orthographic(
        eye=(0.0, 0.0, 12.0), target=(0, 0, 0), up=(0, 1, 0), width=columns, height=rows, **size
    )
    depth = random.uniform(2.0, 20.0, (rows, columns))
    image = DepthImage(color=random.uniform(0.1, 1.0, (rows, columns, 3)), depth=depth, camera=source)
    view = Camera.orthographic(
        eye=(0.031, 0.017, 12.0),
        target=(0.012, -0.023, 0.0),
        up=(0, 1, 0),
        width=APART * columns,
        height=APART * rows,
        **size,
    )
    return Case(
        name="probe-sprites",
        method="splatting",
        kind="typical",
        about="Single points of known sizes, from which it is measured where splats are drawn: `ibr-ref probe`.",
        profile="ieee32",
        scene=Scene(images=[image], camera=view, light=None, background=(0.0, 0.0, 0.0)),
        params=Params(alpha=8.0, gamma=1.0, delta=-0.7, min_width=0.0),
    )


def measure(case: Case, arrays: Mapping[str, Any]) -> Measured:
    """Of a drawing of the case. Raises ValueError for arrays that are missing or have another size."""
    for name in NEEDED:
        if name not in arrays:
            raise checks.reject("probe", f"no {name}", ", ".join(NEEDED))
    camera = case.scene.camera
    shown = np.asarray(arrays["raster.splat"])
    if shown.shape != (camera.height, camera.width):
        raise checks.reject("raster.splat", shown.shape, "the picture's size")
    window, width = (np.asarray(arrays[name], np.float64) for name in NEEDED[:2])
    if window.shape != (GRID[0] * GRID[1], 2) or width.shape != window.shape[:1]:
        raise checks.reject("vertex.window", window.shape, "a row for each point")
    why, faults = dict[str, str](), dict[str, str]()
    found = [_offset(np.array([*_intervals(shown, window, width, axis)]).reshape(-1, 2)) for axis in (0, 1)]
    if None not in found:
        x, y = (float(each or 0.0) for each in found)
        why["sprite_offset"] = f"splats lie {x:+.3f}, {y:+.3f} pixels from their points"
        if max(abs(x), abs(y)) > RASTER:
            faults["sprites beside their points"] = why["sprite_offset"]
    small = np.flatnonzero((width < SMALL) & np.isfinite(window).all(axis=1))
    covered = int(np.isin(small, shown).sum())
    if len(small) >= FEW:
        why["least_sprite"] = f"{covered} of {len(small)} splats below {SMALL} pixels are drawn"
        if covered == len(small):
            faults["sprites one pixel at least"] = f"all {covered} splats below {SMALL} pixels are drawn"
    return Measured({}, why, faults) | _stored(shown, arrays)


def _stored(shown: Any, arrays: Mapping[str, Any]) -> Measured:
    """Which bytes the points' own colours became."""
    picture, colors = (np.asarray(arrays.get(name, 0.0)) for name in ("color", "vertex.color"))
    if picture.dtype != np.uint8 or colors.ndim != 2:
        return Measured()
    seen = shown >= 0
    wanted = 255.0 * np.clip(np.asarray(colors, np.float64)[shown[seen]], 0.0, 1.0)
    off = np.abs(picture[seen] - wanted)[np.abs(wanted - np.floor(wanted) - 0.5) > TIE]
    if len(off) < COLORS or not (off < 1.0).all():
        return Measured()
    nearest = int((off < 0.5).sum())
    why = {"unorm_rounding": f"{nearest} of {len(off)} stored colours are the nearest byte"}
    return Measured({"unorm_rounding": "nearest" if nearest == len(off) else "either"}, why)


def _intervals(shown: Any, window: Floats, width: Floats, axis: int) -> Iterator[tuple[float, float]]:
    """Of each splat's lower and upper border: the offsets along x (0) or y (1) that put it where it is."""
    for splat in np.flatnonzero(width > 1.0):
        covered = np.unique(np.nonzero(shown == splat)[1 - axis])
        if len(covered):
            low, high = (float(window[splat, axis] + side * width[splat] / 2.0) for side in (-1.0, 1.0))
            yield covered[0] - 0.5 - low, covered[0] + 0.5 - low
            yield covered[-1] + 0.5 - high, covered[-1] + 1.5 - high


def _offset(intervals: Floats) -> float | None:
    """The offset that explains most borders: the middle of those that do so equally well. None: none explains most."""
    tried = np.arange(-FARTHEST, FARTHEST + STEP, STEP)
    hits = ((intervals[:, :1] <= tried) & (tried <= intervals[:, 1:])).sum(axis=0)
    if not len(intervals) or hits.max() < AGREE * len(intervals):
        return None
    best = tried[hits == hits.max()]
    return float((best[0] + best[-1]) / 2.0)
