"""What the vertex stage is fed with: a row a point, from the program's atlas, or from the one that the port handed in."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.arithmetic.bounds import Bounds
from ibr_ref.oracle.arithmetic.decisions import joined
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import Handed
from ibr_ref.oracle.programs.splatting import Port as Program
from ibr_ref.oracle.programs.splatting.vertex import Texels
from ibr_ref.oracle.referees.outcomes import stored

Codes = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Table:
    """The points of a case, in order of (image, row, column); V of them, or some."""

    image: Ints
    """(V,) growing."""
    rows: Ints
    columns: Ints
    depth: Number
    """(V,) along the reference's view axis."""
    albedo: Number
    """(V, 3)."""
    codes: Codes
    """(V, 3) 8-bit normals that the points are lit with: the port's own, or those that the case hands over."""
    given: Codes
    """(V, 3) those that the case hands over."""
    usable: Bools
    """(V,) whether the port's texels can be computed with; elsewhere it went wrong before."""

    def __len__(self) -> int:
        return len(self.rows)

    def take(self, index: Ints) -> Table:
        """Some points."""
        return Table(**{name: value[index] for name, value in vars(self).items()})

    @property
    def lightings(self) -> list[Table]:
        """The same with each set of normals: a port that hands in its own may light with those of the case all the same."""
        if np.array_equal(self.codes, self.given):
            return [self]
        return [self, replace(self, codes=self.given)]

    def shares(self) -> list[tuple[int, slice]]:
        """Each image and its rows."""
        ends = [0, *(np.flatnonzero(np.diff(self.image)) + 1).tolist(), len(self)] if len(self) else [0]
        return [(int(self.image[first]), slice(first, stop)) for first, stop in pairwise(ends)]

    def texels(self, share: slice) -> Texels:
        """What the program is run on."""
        codes = list(self.codes[share].T.astype(np.float64))
        return Texels(self.rows[share], self.columns[share], self.depth[share], self.albedo[share].T, codes)


def table(program: Program, atlas: dict[str, Any], given: list[Codes], handed: Handed) -> Table:
    """All points, with the port's own depths, colours and normals where it handed in an atlas that has them."""
    do = program.do
    rects = np.asarray(handed.get("atlas.rects", atlas["atlas.rects"]), np.int64)
    depths = [stored(do, page) for page in handed.get("atlas.depth", ())]
    colors = [_texel_color(do, page) for page in handed.get("atlas.color", ())]
    parts = []
    for number, image in enumerate(program.scene.images):
        rows, columns = np.nonzero(image.arrays[2])
        mine = program.texels(number, atlas, given[number])
        codes = np.stack(mine.codes, axis=1).astype(np.uint8)
        depth, albedo = mine.depth, joined_columns(mine.albedo)
        usable = np.ones(len(rows), np.bool_)
        if depths:
            depth, there = _fetched(program, depths, rects[number], rows, columns)
            usable &= there
        if colors:
            albedo, there = _fetched(program, colors, rects[number], rows, columns)
            usable &= there.all(axis=1)
        own = codes
        if "atlas.normal" in handed:
            own, there = _own_codes(program, handed["atlas.normal"], rects[number], codes, rows, columns)
            usable &= there
        of = np.full(len(rows), number)
        parts.append(Table(of, rows, columns, depth, albedo, own, codes, usable))
    return Table(**{name: joined([getattr(part, name) for part in parts]) for name in vars(parts[0])})


def joined_columns(components: list[Number]) -> Number:
    """(n, c) of c numbers (n,)."""
    stacked: Any = np.stack  # of numbers it is a number
    found: Number = stacked(components, axis=-1)
    return found


def _fetched(program: Program, pages: list[Number], rect: Ints, rows: Ints, columns: Ints) -> tuple[Number, Bools]:
    """The port's texels, and which are numbers; 1 and no elsewhere."""
    shape = (len(rows), *pages[0].shape[2:])
    if not on_page(pages, rect, rows, columns):
        return Number(program.do, np.ones(shape)), np.zeros(shape, np.bool_)
    found = program.fetch(tuple(pages), rect, rows, columns)
    there = np.isfinite(found.value)
    return program.do.where(there, found, 1.0), there


def _own_codes(
    program: Program, pages: Any, rect: Ints, codes: Codes, rows: Ints, columns: Ints
) -> tuple[Codes, Bools]:
    """The port's normals, where its rectangle lies on a page."""
    if not on_page(pages, rect, rows, columns):
        return codes, np.zeros(len(rows), np.bool_)
    page, x, y = (int(number) for number in rect[:3])
    found = program.fetch_normals(np.asarray(pages[page])[y:, x:], rows, columns)
    return found.astype(np.uint8), np.ones(len(rows), np.bool_)


def on_page(pages: Any, rect: Ints, rows: Ints, columns: Ints) -> bool:
    """Whether texels of an image lie on its page."""
    page, x, y = (int(number) for number in rect[:3])
    if not 0 <= page < len(pages) or min(x, y) < 0:
        return False
    height, width = np.shape(pages[page])[:2]
    return bool(y + rows.max(initial=0) < height and x + columns.max(initial=0) < width)


def _texel_color(do: Bounds, texels: Any) -> Number:
    """The port's own colours: of a byte each fetch is a quotient of its own; floats are what they are."""
    texels = np.asarray(texels, np.float64)
    bytes_ = np.rint(255.0 * np.clip(np.nan_to_num(texels), 0.0, 1.0)) / 255.0
    fetched = do.widened(do.texels(bytes_), quotients=1)
    return do.where(np.abs(texels - bytes_) <= fetched.error + UNIT * bytes_, fetched, stored(do, texels))
