"""One pixel: the splats that may be seen there, and the colour of the one that is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools
from ibr_ref.oracle.accept.bounded import Bounded, converted, exact, stored, uploaded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.accept.coverage import RASTER
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import UNIT, Device
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.referees.rows import color, compared, number, told
from ibr_ref.oracle.referees.splatting.lighting import shades
from ibr_ref.oracle.referees.splatting.place import Landed, landed, placed
from ibr_ref.oracle.referees.splatting.spans import axis, border
from ibr_ref.oracle.referees.splatting.splats import Contest, buffered, contest
from ibr_ref.oracle.referees.splatting.table import Table, fed_table
from ibr_ref.oracle.referees.splatting.trace.points import alone, colored

MOST = 8
"""Splats that are listed, the nearest first."""


@dataclass(frozen=True, eq=False)
class Pixel:
    """What a pixel (row, column) is replayed from, and what it is compared with."""

    case: Case
    device: Device
    fed: Handed
    handed: Handed
    at: tuple[int, int]
    points: Table
    where: Landed
    result: Contest

    def own(self, name: str) -> NDArray[np.generic] | None:
        """The port's number."""
        return np.asarray(np.asarray(self.handed[name])[self.at]) if name in self.handed else None

    @property
    def exists(self) -> range:
        """The splats that there are."""
        return range(len(self.points.rows))


def pixel(case: Case, device: Device, fed: Handed, handed: Handed, at: tuple[int, int]) -> list[TraceRow]:
    """The contest for a pixel. fed: the arrays that it is replayed from; handed: those it is compared with."""
    camera = case.scene.camera
    points = fed_table(case, device, fed)
    where = landed(case, device, points, fed)
    result = contest(where, case.params.shape, camera.width, camera.height)
    one = Pixel(case, device, fed, handed, at, points, where, result)
    splats = result.splat[result.pixel == at[0] * camera.width + at[1]]
    splats = splats[np.argsort(where.depth.value[splats], kind="stable")]
    covering = np.flatnonzero(covers(where, case.params.shape, at))
    winner = _winner(where, covering)
    port = one.own("raster.splat")
    listed = [int(splat) for splat in splats[:MOST]]
    listed += [v for v in (winner, -1 if port is None else int(port)) if v in one.exists and v not in listed]
    rows = [told("splats that may win", len(splats))]
    for splat in dict.fromkeys(listed):
        rows += _splat(one, splat)
    named = "raster.splat" in fed and port is not None and (int(port) == -1 or int(port) in one.exists)
    shown = int(port) if named and port is not None else winner
    rows += [_named(one, winner, splats), _depth(one, shown), _overdraw(one, len(covering))]
    return rows + _picture(one, shown)


def covers(where: Landed, shape: str, at: tuple[int, int]) -> Bools:
    """(V,) which splats cover a pixel, in exact arithmetic."""
    x, y = (np.rint(RASTER * c.value) / RASTER for c in (where.x, where.y))
    width, row, column = where.width.value, at[0] + 0.5, at[1] + 0.5
    inside = where.kept & (width > 0.0)
    for center, index in ((x, column), (y, row)):
        inside &= (index >= center - width / 2.0) & (index < center + width / 2.0)
    if shape == "disc":
        inside &= (column - x) ** 2 + (row - y) ** 2 <= width * width / 4.0
    return np.asarray(inside, np.bool_)


def _winner(where: Landed, covering: NDArray[np.int64]) -> int:
    """The nearest, of equal ones the first; -1 none."""
    depth = where.depth.value[covering]
    if not len(depth) or not depth.min() < 1.0:
        return -1
    return int(covering[np.argmin(depth)])


def _named(one: Pixel, winner: int, splats: NDArray[np.int64]) -> TraceRow:
    port = one.own("raster.splat")
    pixel = one.at[0] * one.case.scene.camera.width + one.at[1]
    legal = port is None or int(port) in splats or (int(port) == -1 and bool(one.result.empty[pixel]))
    return told("winner (-1 none)", winner, port, legal=legal, array="raster.splat")


def _splat(one: Pixel, splat: int) -> list[TraceRow]:
    """Its borders, as distances from the pixel's centre: positive inside."""
    name, where = f"splat {splat}", one.where
    if not where.possible[splat] or not np.isfinite(where.width.value[splat]):
        return [told(f"{name}: drawn", "no")]
    index, rows, away, off = np.array([splat]), [], [], []
    width = where.width[index]
    for label, center, place in (("x", where.x, one.at[1]), ("y", where.y, one.at[0])):
        spans = axis(center[index], width, 2**30)
        half, snap = (
            float(width.value[0]) / 2.0,
            float(max(spans.high[0] - spans.reference[0], spans.reference[0] - spans.low[0])) - one.device.splat_border,
        )
        bound = float((width.error / 2.0 + border(spans.reference, width, one.device))[0]) + snap
        first, last = float(spans.reference[0]) - half, float(spans.reference[0]) + half
        low, high = place + 0.5 - first, last - (place + 0.5)
        rows.append(compared(f"{name}: {label} >= {first:.9g}", low >= 0.0, low, bound))
        rows.append(compared(f"{name}: {label} < {last:.9g}", high > 0.0, high, bound))
        away.append(place + 0.5 - float(spans.reference[0]))
        off.append(snap + one.device.splat_border)
    if one.case.params.shape == "disc":
        rows.append(_disc(name, away, off, width, one.device))
    depth: Bounded = buffered(where.depth)
    return [*rows, number(f"{name}: depth", [depth[splat]])]


def _disc(name: str, away: list[float], off: list[float], width: Bounded, device: Device) -> TraceRow:
    """dx^2 + dy^2 <= w^2 / 4, by the difference of the sides."""
    square, limit = away[0] ** 2 + away[1] ** 2, float(width.value[0]) ** 2 / 4.0
    half = float(width.error[0]) / 2.0 + device.splat_border
    moved = sum(2.0 * abs(d) * e + e * e for d, e in zip(away, off, strict=True))
    bound = moved + half * (float(width.value[0]) + half) + device.operation * UNIT * (5.0 * square + 2.0 * limit)
    step = f"{name}: dx^2 + dy^2 = {square:.9g} <= w^2 / 4 = {limit:.9g}"
    return compared(step, square <= limit, limit - square, bound)


def _overdraw(one: Pixel, covering: int) -> TraceRow:
    place, port = one.at[0] * one.case.scene.camera.width + one.at[1], one.own("raster.overdraw")
    least, most = one.result.least[place], one.result.most[place]
    legal = port is None or bool(least <= int(port) <= most)
    step = "overdraw" if least == most else f"overdraw, legal from {least} to {most}"
    return told(step, covering, port, legal=legal, array="raster.overdraw")


def _depth(one: Pixel, shown: int) -> TraceRow:
    """The depth buffer, of the splat that the port shows if that may be."""
    port, named = one.own("raster.depth"), one.own("raster.splat")
    splat = int(named) if named is not None and int(named) in one.exists else shown
    depth = exact(1.0, one.device) if splat < 0 else one.result.depth[splat]
    return number("depth buffer", [depth], port, array="raster.depth")


def _picture(one: Pixel, shown: int) -> list[TraceRow]:
    """Colour and depth of what is shown."""
    case, device, rows = one.case, one.device, []
    background = np.asarray(case.scene.background, np.float64)
    depth, other = exact(1.0, device), None
    legal = uploaded(background, device)
    if shown >= 0:
        point = alone(one.points, shown)
        where = placed(case, device, point)
        own = np.asarray(one.handed["vertex.color"])[shown] if "vertex.color" in one.handed else None
        rows += colored(case, device, point, where, own)
        colors = shades(case, device, where.world, point.codes, point.albedo)
        legal, other = colors.color[0], colors.other[0] if colors.split[0] else None
        if "vertex.color" in one.fed and own is not None and np.isfinite(own).all():
            legal, other = stored(own.astype(np.float64), device), None
        depth = buffered(one.where.depth)[shown]
        buffer = one.own("raster.depth") if "raster.depth" in one.fed else None
        if buffer is not None and np.isfinite(buffer.astype(np.float64)):
            read = (converted if device.depth_step else stored)(buffer.astype(np.float64), device)
            depth = read.widened(UNIT * np.abs(read.value))
    found = one.own("depth")
    if found is not None:
        rows.append(number("picture: depth", [depth], found, array="depth"))
    found = one.own("color")
    if found is not None:
        legal, *others = (c.widened(UNIT * np.abs(c.value)) for c in (legal, other) if c is not None)
        right = any(bool(allows_color(c, found).all()) for c in (legal, *others))
        rows.append(color("picture: colour", [legal[c] for c in range(3)], found, right))
    return rows
