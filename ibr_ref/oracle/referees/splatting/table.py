"""What the vertex stage is fed with: a row a point, from the case, or from the atlas that the port handed in."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.accept.bounded import Bounded, stored, uploaded
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import UNIT, Device
from ibr_ref.oracle.judgement import Handed


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
    """(V, 3) 8-bit normals that the points are lit with: the port's own, or those that the case hands over."""
    usable: Bools
    """(V,) whether the port's texels can be computed with; elsewhere it went wrong before."""
    given: NDArray[np.uint8]
    """(V, 3) the normals that the case hands over."""

    @property
    def shares(self) -> list[slice]:
        """The rows of each image's points."""
        return [slice(first, stop) for first, stop in pairwise(self.starts.tolist())]

    @property
    def lightings(self) -> list[Table]:
        """The same with each set of normals: a port that hands in its own may light with those of the case all the same."""
        if np.array_equal(self.codes, self.given):
            return [self]
        return [self, replace(self, codes=self.given)]


def table(case: Case, device: Device, handed: Handed | None = None) -> Table:
    """The points, with the port's own depths, colours and normals where it handed in an atlas that has them."""
    handed = {} if handed is None else handed
    images = [image.arrays for image in case.scene.images]
    places = [np.nonzero(mask) for _, _, mask in images]
    counts = [len(rows) for rows, _ in places]
    rows, columns = (np.concatenate([place[axis] for place in places]) for axis in (0, 1))
    depth = uploaded(np.concatenate([depth[mask] for _, depth, mask in images]), device)
    albedo = stored_color(np.concatenate([color[mask] for color, _, mask in images]), device)
    given = np.concatenate([codes[place] for codes, place in zip(normal_codes(case), places, strict=True)])
    codes, usable = given, np.ones(len(rows), np.bool_)
    rects = np.asarray(handed.get("atlas.rects", case.frame.stages["atlas.rects"]), np.int64)
    for name in ("atlas.depth", "atlas.color", "atlas.normal"):
        if name in handed:
            texels, there = _fetched(handed[name], rects, places)
            texels = np.where(there, texels.T, 1.0).T
            if name == "atlas.depth":
                depth = stored(texels, device)
            elif name == "atlas.color":
                albedo = _texel_color(texels, device)
            else:
                codes = texels.astype(np.uint8)
            usable &= there
    return Table(
        starts=np.cumsum([0, *counts]),
        rows=rows,
        columns=columns,
        depth=depth,
        albedo=albedo,
        codes=codes,
        usable=usable,
        given=given,
    )


def fed_table(case: Case, device: Device, handed: Handed) -> Table:
    """The points for a later stage: from the port's atlas, or where that cannot be computed with, from the case."""
    points = table(case, device, handed)
    return points if points.usable.all() else table(case, device)


def stored_color(color: NDArray[np.float64], device: Device) -> Bounded:
    """Colours as a texture has them: rounded once, or k / 255 of a byte, which is a quotient."""
    return uploaded(color, device).widened(device.quotient * UNIT * color)


def _texel_color(texels: NDArray[np.float64], device: Device) -> Bounded:
    """The port's own colours: of a byte each fetch is a quotient of its own; floats are what they are."""
    bytes_ = np.rint(255.0 * np.clip(texels, 0.0, 1.0)) / 255.0
    exactly = stored_color(bytes_, device)
    return exactly.where(np.abs(texels - bytes_) <= exactly.error + UNIT * bytes_, stored(texels, device))


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
        there.append(np.isfinite(texels).all(axis=tuple(range(1, texels.ndim))))
    return np.concatenate(parts), np.concatenate(there)
