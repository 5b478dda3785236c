"""The computation of one element, step by step: what the program tells of while it runs, beside what the port has."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.pipeline.splats import Contest, contest
from ibr_ref.oracle.programs.splatting.raster import Fragments, Splats
from ibr_ref.oracle.referees.rows import color, compared, compared_numbers, journaled, number, one, text, told
from ibr_ref.oracle.referees.splatting.model import NOTHING, Branch, Model
from ibr_ref.oracle.referees.splatting.pixels import Seen, colors_of, outcomes, shown
from ibr_ref.oracle.referees.splatting.points import Port, allowed
from ibr_ref.oracle.referees.splatting.table import Table
from ibr_ref.oracle.referees.splatting.texels import codes_of, cut_out, page_of, read

MOST = 8
"""Splats that are listed, the nearest first."""
_PLACED = ("fetch: depth", "world x, y, z", "distance d of the law", "w > 0", "0 <= z", "z <= w")
"""Told of with the place."""


def trace(model: Model, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
    """Rows of one element; index: (vertex,), (row, column) of a pixel, or (texel,) in the order of its judgement.

    Raises ValueError for a stage that the method has not.
    """
    if stage == "normals":
        return _normal(model, handed, index[0])
    if stage == "atlas":
        return _texel(model, handed, index[0])
    if stage == "vertex":
        return _point(Port(model, handed), index[0])
    if stage in ("raster", "resolve", "image"):
        return _Pixel(Port(model, NOTHING if stage == "image" else handed), handed, (index[0], index[1])).rows()
    raise ValueError(f"stage: found {stage!r}, allowed: normals | atlas | vertex | raster | resolve | image")


@contextmanager
def journal(model: Model) -> Iterator[list[tuple[str, Any]]]:
    """What the program tells of meanwhile; what may go either way goes as the numbers have it."""
    kept: list[tuple[str, Any]] = []
    model.machine.begin(np.zeros(1, np.int64))
    model.machine.journal = kept
    try:
        yield kept
    finally:
        model.machine.journal = None


# --- Texels ----------------------------------------------------------------------------------------------------------


def _normal(model: Model, handed: Handed, texel: int) -> list[TraceRow]:
    """The neighbours, the outcomes, and the codes."""
    images = model.case.scene.images
    ends = np.cumsum([0, *(np.size(image.arrays[1]) for image in images)])
    image = int(np.searchsorted(ends, texel, side="right")) - 1
    pixel, mask = texel - int(ends[image]), images[image].arrays[2]
    row, column = (int(i) for i in np.unravel_index(pixel, mask.shape))
    rows = [told("image, row, column", (image, row, column)), told("on the mask", bool(mask[row, column]))]
    among = np.arange(mask.size) == pixel
    pixels, codes, _ = codes_of(model, image, among)
    if mask[row, column]:
        surface = model.preparation.surface(images[image])
        rows.append(number("depth", one(surface.depth, pixel)))
        with journal(model) as kept:
            model.preparation.codes_at(surface, np.array([pixel]))
        rows += journaled(kept)
        for i in range(len(pixels)):
            ends_ = ([getattr(x, end)[i] for x in codes] for end in ("low", "high"))
            rows.append(told("codes of one outcome, from and to", " to ".join(text(each) for each in ends_)))
    mine = cut_out(model.case.frame.stages["atlas.normal"], model.case.frame.stages["atlas.rects"][image])
    every, all_codes, _ = codes_of(model, image)
    found, rect, hidden = read(model, handed, image, every, all_codes)
    if mine is None or np.isnan(found).all():
        return rows
    port = found[pixel]
    legal = bool(hidden[pixel]) or any(
        all(x.low[i] <= p <= x.high[i] for x, p in zip(codes, port, strict=True)) for i in range(len(pixels))
    )
    legal |= not mask[row, column] and not port.any()
    at = (int(rect[0]), row + int(rect[2]), column + int(rect[1]))
    return [*rows, compared_numbers("code", mine[row, column].astype(np.float64), port, legal, "atlas.normal", at)]


def _texel(model: Model, handed: Handed, texel: int) -> list[TraceRow]:
    """Where it lies, whose it is, and its three maps."""
    stages = model.case.frame.stages
    shapes = [page.shape[:2] for page in stages["atlas.depth"]]
    ends = np.cumsum([0, *(int(np.prod(shape)) for shape in shapes)])
    page = int(np.searchsorted(ends, texel, side="right")) - 1
    row, column = (int(i) for i in np.unravel_index(texel - int(ends[page]), shapes[page]))
    rows = [told("page, row, column", (page, row, column))]
    for image, rect in enumerate(stages["atlas.rects"].tolist()):
        if rect[0] == page and rect[1] <= column < rect[1] + rect[3] and rect[2] <= row < rect[2] + rect[4]:
            rows.append(_rectangle(model, handed, image))
    for name in ("atlas.color", "atlas.depth"):
        legal = model.atlas[name][page][row, column]
        parts = [one(x) for x in legal.each(np.atleast_1d, None)]
        port = page_of(handed[name], page, shapes[page]).value[row, column] if name in handed else None
        rows.append(number(name, parts, port, array=name, index=(page, row, column)))
    if "atlas.normal" in handed:
        mine = stages["atlas.normal"][page][row, column]
        theirs = page_of(handed["atlas.normal"], page, shapes[page]).value[row, column]
        beside = mine.any() or np.array_equal(mine, theirs)  # of an image: judged before
        place = (page, row, column)
        rows.append(compared_numbers("atlas.normal", mine.astype(float), theirs, beside, "atlas.normal", place))
    return rows


def _rectangle(model: Model, handed: Handed, image: int) -> TraceRow:
    """Where an image lies."""
    mine, theirs = (
        None if array is None else ", ".join(map(str, np.asarray(array)[image].tolist()))
        for array in (model.case.frame.stages["atlas.rects"], handed.get("atlas.rects"))
    )
    row = told(f"image {image}: page, x, y, width, height", mine, theirs, array="atlas.rects", index=(image,))
    return replace(row, element="image")


# --- Points ----------------------------------------------------------------------------------------------------------


def _point(port: Port, vertex: int) -> list[TraceRow]:
    """From the texel to the window, the width and the colour."""
    point = port.table.take(np.array([vertex]))
    model, own = port.model, {n: np.asarray(a)[vertex] for n, a in port.handed.items() if n.startswith("vertex.")}
    source = ", ".join(str(int(each[0])) for each in (point.image, point.rows, point.columns))
    mine = None if "vertex.source" not in own else ", ".join(str(int(each)) for each in own["vertex.source"])
    with journal(model) as kept:
        model.placed(point)
    rows = [told("image, row, column", source, mine, array="vertex.source"), *journaled(kept)]
    return [*rows, *_landed(model, point, own), *lit(model, point, own.get("vertex.color"))]


def _landed(model: Model, point: Table, own: dict[str, Any]) -> list[TraceRow]:
    """Where the point is in the window, and how wide; as the port has decided where both is legal."""
    placed = model.placed(point)
    kept = bool(placed.possible[0])
    if kept and not placed.sure[0] and "vertex.width" in own:
        kept = bool(own["vertex.width"] > 0.0)
    if not kept:
        nothing = {"vertex.window": "nan, nan", "vertex.depth": "nan", "vertex.width": "0"}
        port = {name: text(own[name]) for name in nothing if name in own}
        return [told(f"dropped: {name}", left, port.get(name), array=name) for name, left in nothing.items()]
    window = [one(x) for x in placed.window]
    return [
        number("window x, y", window, own.get("vertex.window"), array="vertex.window"),
        number("window depth z / w", one(placed.depth), own.get("vertex.depth"), array="vertex.depth"),
        number("width, clamped", one(placed.width), own.get("vertex.width"), array="vertex.width"),
    ]


def lit(model: Model, point: Table, found: Any = None) -> list[TraceRow]:
    """The light on the only point of a table: with the normal that the port's colour agrees with, if one does."""
    branches: list[Branch] = []
    for lighting in reversed(point.lightings):
        branches, point = model.colors(lighting, model.placed(lighting).world), lighting
        if found is None or allowed(branches, np.asarray(found, np.float64)[None])[0]:
            break
    with journal(model) as kept:
        image, texels = model.case.scene.images[int(point.image[0])], point.texels(slice(None))
        model.program.lit(image, model.placed(point).world, texels.codes, texels.albedo)
    rows = journaled([entry for entry in kept if entry[0] not in _PLACED])
    branches = [branch for branch in branches if branch.legal[0]]
    legal = [allowed([b], np.asarray(found, np.float64)[None])[0] if found is not None else False for b in branches]
    best = int(np.argmax(legal))
    for k, branch in enumerate(branches):
        # Stored as a float32 once more, as where it is judged.
        bounds = [stored_again(one(x)) for x in branch.color.T]
        step = "colour" if k == best else "colour with n.l > 0 decided otherwise"
        rows.append(number(step, bounds, found if k == best else None, array="vertex.color" if k == best else ""))
    return rows


def stored_again(bound: Bounded) -> Bounded:
    """With one rounding more."""
    return bound.widened(UNIT * np.abs(bound.value))


# --- Pixels ----------------------------------------------------------------------------------------------------------


class _Pixel:
    """A pixel (row, column), by what it is replayed from (`port`), beside all that was handed in."""

    def __init__(self, port: Port, handed: Handed, at: tuple[int, int]) -> None:
        self.port, self.model, self.handed, self.at = port, port.model, handed, at
        camera = port.model.case.scene.camera
        self.pixel = at[0] * camera.width + at[1]
        self.result: Contest = contest(self.model.program, port.landed)
        # The reference computes in float64, and decides as its numbers have it.
        self.exact = self.model.kind(port.model.case.scene, port.model.case.params, Policy(float_bits=64), {})

    def rows(self) -> list[TraceRow]:
        """The splats that may be seen there, and the colour of the one that is."""
        landed, port = self.port.landed, self.own("raster.splat")
        splats = self.result.splat[self.result.pixel == self.pixel]
        splats = splats[np.argsort(landed.depth.value[splats], kind="stable")]
        covering = self.covering()
        winner = self.winner(covering)
        count = len(self.port.fed)
        listed = [int(splat) for splat in splats[:MOST]]
        listed += [v for v in (winner, -1 if port is None else int(port)) if 0 <= v < count]
        rows = [told("splats that may win", len(splats))]
        for splat in dict.fromkeys(listed):
            rows += self.splat(splat)
        named = "raster.splat" in self.port.handed and port is not None and -1 <= int(port) < count
        at = int(port) if named and port is not None else winner
        return [*rows, self.named(winner, splats), self.depth(at), self.overdraw(len(covering)), *self.picture(at)]

    def own(self, name: str) -> NDArray[np.generic] | None:
        """The port's number."""
        return np.asarray(np.asarray(self.handed[name])[self.at]) if name in self.handed else None

    def drawn(self, vertices: Ints) -> Splats:
        """Splats of the reference."""
        landed = self.port.landed
        window = [x.value[vertices] for x in landed.window]
        return self.exact.splats(vertices, window, landed.width.value[vertices], landed.depth.value[vertices])

    def covering(self) -> Ints:
        """The splats that cover the pixel in the reference."""
        landed = self.port.landed
        near = np.flatnonzero(landed.possible & (landed.width.value > 0.0))
        reach = 0.5 * landed.width.value[near] + 1.0
        for x, index in zip(landed.window, self.at[::-1], strict=True):
            inside = np.abs(x.value[near] - index - 0.5) <= reach
            near, reach = near[inside], reach[inside]
        splats = self.drawn(near)
        fragments = self.exact.fragments(splats)
        here = (fragments.row == self.at[0]) & (fragments.column == self.at[1])
        return np.asarray(splats.vertex[fragments.splat[here]])

    def winner(self, covering: Ints) -> int:
        """The nearest, of equal ones the first; -1 none."""
        depth = self.port.landed.depth.value[covering]
        return int(covering[np.argmin(depth)]) if len(depth) and depth.min() < 1.0 else -1

    def splat(self, splat: int) -> list[TraceRow]:
        """Its borders, as distances from the pixel's centre: positive inside."""
        name, landed, program = f"splat {splat}", self.port.landed, self.model.program
        if not landed.possible[splat] or not np.isfinite(landed.width.value[splat]):
            return [told(f"{name}: drawn", "no")]
        at, rows = np.array([splat]), []
        legal = program.splats(at, [x[at] for x in landed.window], landed.width[at], landed.depth[at])
        exact = self.drawn(at)
        for label, index in (("x", self.at[1]), ("y", self.at[0])):
            ends = program.borders(getattr(legal, label), program.half(legal.width))
            values = self.exact.borders(getattr(exact, label), self.exact.half(exact.width))
            (first, off_first), (last, off_last) = (_end(*pair) for pair in zip(values, ends, strict=True))
            low, high = index + 0.5 - first, last - (index + 0.5)
            rows.append(compared(f"{name}: {label} >= {first:.9g}", low >= 0.0, low, off_first))
            rows.append(compared(f"{name}: {label} < {last:.9g}", high > 0.0, high, off_last))
        return [*rows, *self.disc(name, legal), number(f"{name}: depth", one(self.result.depth, splat))]

    def disc(self, name: str, splats: Splats) -> list[TraceRow]:
        """dx^2 + dy^2 <= w^2 / 4."""
        if self.model.case.params.shape != "disc":
            return []
        where = (np.zeros(1, np.int64), *(np.array([index]) for index in self.at))
        return journaled([(f"{name}: dx^2 + dy^2 <= w^2 / 4", self.model.program.in_disc(splats, Fragments(*where)))])

    def named(self, winner: int, splats: Ints) -> TraceRow:
        """Who wins."""
        port = self.own("raster.splat")
        legal = port is None or int(port) in splats or (int(port) == -1 and bool(self.result.empty[self.pixel]))
        return told("winner (-1 none)", winner, port, legal=legal, array="raster.splat")

    def depth(self, at: int) -> TraceRow:
        """The depth buffer, of the splat that the port shows if that may be."""
        port, named = self.own("raster.depth"), self.own("raster.splat")
        splat = int(named) if named is not None and 0 <= int(named) < len(self.port.fed) else at
        depth = one(self.result.depth, splat) if splat >= 0 else one(Number(self.model.machine, 1.0))
        return number("depth buffer", depth, port, array="raster.depth")

    def overdraw(self, covering: int) -> TraceRow:
        """How many splats cover it."""
        port, least, most = self.own("raster.overdraw"), *(x[self.pixel] for x in (self.result.least, self.result.most))
        legal = port is None or bool(least <= int(port) <= most)
        step = "overdraw" if least == most else f"overdraw, legal from {least} to {most}"
        return told(step, covering, port, legal=legal, array="raster.overdraw")

    def picture(self, at: int) -> list[TraceRow]:
        """Colour and depth of what is shown."""
        rows, model, points = [], self.model, self.port.fed
        own = self.own_color(at)
        if at >= 0:
            rows += lit(model, points.take(np.array([at])), own)
        found = self.seen()
        here = found.take(found.pixel == self.pixel)
        mine = np.flatnonzero(here.winner == at)
        chosen = int(mine[0]) if len(mine) else 0
        if (depth := self.own("depth")) is not None and len(here.pixel):
            legal = bool(here.depth.allows(depth).any())
            rows.append(self.compared("picture: depth", here.depth[chosen : chosen + 1], depth, legal, "depth"))
        if (port := self.own("color")) is not None and len(here.pixel):
            rows.append(self.color(here, chosen, port))
        return rows

    def own_color(self, at: int) -> Any:
        """The port's own of a point."""
        return np.asarray(self.handed["vertex.color"])[at] if at >= 0 and "vertex.color" in self.handed else None

    def seen(self) -> Seen:
        """All that may be shown."""
        return outcomes(self.port)

    def color(self, here: Seen, chosen: int, port: NDArray[np.generic]) -> TraceRow:
        """The pixel of the picture."""
        colors = [
            shown(self.model, here, colors_of(self.model, points, self.port.landed, here.winner, self.port.handed))
            for points in self.port.fed.lightings
        ]
        bounds = [Bounded(c.color.value, c.color.deviation, self.model.machine.device) for c in colors]
        fits = [allows_color(b, port).all(axis=1) for b in bounds]
        k = next((i for i, each in enumerate(fits) if each.any()), 0)
        row = int(np.argmax(fits[k])) if fits[k].any() else int(np.flatnonzero(colors[k].row == chosen)[0])
        return color("picture: colour", [bounds[k][row, c] for c in range(3)], port, bool(fits[k].any()))

    def compared(self, step: str, legal: Number, found: Any, right: bool, array: str) -> TraceRow:
        """A number of the picture, which another outcome may have."""
        value = np.atleast_1d(legal.value)
        return compared_numbers(step, value, np.atleast_1d(found), right, array, None, float(legal.deviation[0]))


def _end(value: Floats, legal: Number) -> tuple[float, float]:
    """A border, and how far a device's may lie from there."""
    exact = float(value[0])
    return exact, float(max(legal.high[0] - exact, exact - legal.low[0]))
