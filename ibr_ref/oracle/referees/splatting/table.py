"""What the vertex stage is fed with: a row a point, from the case, or from the atlas that the port handed in."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bounded import Bounded, exact, uploaded
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import UNIT, Device
from ibr_ref.oracle.judgement import Handed

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Table:
    """The points of a case, in order of (image, row, column); V of them."""

    starts: Ints
    """(N + 1,) where each image's share starts."""
    rows: Ints
    columns: Ints
    depth: Bounded
    """(V,) along the reference's view axis."""
    albedo: Bounded
    """(V, 3)."""
    codes: NDArray[np.uint8]
    """(V, 3) 8-bit normals that the points are lit with: an input of the case."""
    usable: Bools
    """(V,) whether the port's texels can be computed with; elsewhere it went wrong before."""
    fed: tuple[str, ...]
    """The port's own arrays that are in here."""

    @property
    def shares(self) -> list[slice]:
        """The rows of each image's points."""
        return [slice(first, stop) for first, stop in pairwise(self.starts.tolist())]


def table(case: Case, device: Device, handed: Handed | None = None) -> Table:
    """The points, with the port's own depths and colours where it handed in an atlas that has them."""
    handed = {} if handed is None else handed
    images = [image.arrays for image in case.scene.images]
    places = [np.nonzero(mask) for _, _, mask in images]
    counts = [len(rows) for rows, _ in places]
    rows, columns = (np.concatenate([place[axis] for place in places]) for axis in (0, 1))
    depth = uploaded(np.concatenate([depth[mask] for _, depth, mask in images]), device)
    albedo = stored_color(np.concatenate([color[mask] for color, _, mask in images]), device)
    usable, fed = np.ones(len(rows), np.bool_), []
    rects = np.asarray(handed.get("atlas.rects", case.frame.stages["atlas.rects"]), np.int64)
    for name in ("atlas.depth", "atlas.color"):
        if name in handed:
            texels, there = _fetched(handed[name], rects, places)
            given = exact(np.where(there, texels.T, 1.0).T, device)
            depth, albedo = (given, albedo) if name == "atlas.depth" else (depth, given)
            usable &= there
            fed.append(name)
    if fed and "atlas.rects" in handed:
        fed.append("atlas.rects")
    return Table(
        starts=np.cumsum([0, *counts]),
        rows=rows,
        columns=columns,
        depth=depth,
        albedo=albedo,
        codes=np.concatenate([codes[place] for codes, place in zip(normal_codes(case), places, strict=True)]),
        usable=usable,
        fed=tuple(fed),
    )


def stored_color(color: NDArray[np.float64], device: Device) -> Bounded:
    """Colours as a texture has them: rounded once, or k / 255 of a byte, which is a quotient."""
    return uploaded(color, device).widened(device.quotient * UNIT * color)


def normal_codes(case: Case) -> list[NDArray[np.uint8]]:
    """(H, W, 3) 8-bit normals of each image: those that the case hands over, or the reference's."""
    if "normals" in case.inputs:
        return [np.asarray(codes) for codes in case.inputs["normals"]]
    pages, rects = case.frame.stages["atlas.normal"], case.frame.stages["atlas.rects"]
    return [pages[page][y : y + height, x : x + width] for page, x, y, width, height in rects.tolist()]


def cut_out(pages: Any, rect: NDArray[np.int64]) -> NDArray[Any] | None:
    """An image's texels from the pages of an atlas; None where the rectangle does not lie on one."""
    page, x, y, width, height = (int(number) for number in rect)
    if not 0 <= page < len(pages) or min(x, y) < 0:
        return None
    rows, columns = np.shape(pages[page])[:2]
    if y + height > rows or x + width > columns:
        return None
    return np.asarray(pages[page])[y : y + height, x : x + width]


def _fetched(pages: Any, rects: Ints, places: list[tuple[Ints, ...]]) -> tuple[NDArray[np.float64], Bools]:
    """The texels of all points, and whether they are there and finite."""
    parts, there = [], []
    channels = np.shape(pages[0])[2:]
    for rect, place in zip(rects, places, strict=True):
        texels, found = np.full((len(place[0]), *channels), np.nan), cut_out(pages, rect)
        if found is not None:
            inside = (place[0] < found.shape[0]) & (place[1] < found.shape[1])
            texels[inside] = found[place[0][inside], place[1][inside]]
        parts.append(texels)
        there.append(np.isfinite(texels).reshape(len(texels), -1).all(axis=1))
    return np.concatenate(parts), np.concatenate(there)
