"""One pixel: the splats that may be seen there, and the colour of the one that is."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.referees.splatting.place import Landed, landed, placed
from ibr_ref.oracle.referees.splatting.spans import axis, border
from ibr_ref.oracle.referees.splatting.splats import Contest, buffered, contest
from ibr_ref.oracle.referees.splatting.table import fed_table
from ibr_ref.oracle.referees.splatting.trace.points import alone, colored
from ibr_ref.oracle.referees.splatting.trace.rows import DIFFERS, compared, number, text, told

MOST = 8
"""Splats that are listed, the nearest first."""


def pixel(case: Case, device: Device, fed: Handed, handed: Handed, at: tuple[int, int]) -> list[TraceRow]:
    """The contest for a pixel (row, column). fed: the arrays that it is replayed from; handed: those it is compared with."""
    camera = case.scene.camera
    points = fed_table(case, device, fed)
    where = landed(case, device, points, fed)
    result = contest(where, case.params.shape, camera.width, camera.height)
    splats = result.splat[result.pixel == at[0] * camera.width + at[1]]
    splats = splats[np.argsort(where.depth.value[splats], kind="stable")]
    reference = int(case.frame.stages["raster.splat"][at])
    port = int(np.asarray(handed["raster.splat"])[at]) if "raster.splat" in handed else None
    listed = [int(splat) for splat in splats[:MOST]]
    listed += [v for v in (reference, port) if v is not None and 0 <= v < len(points.rows) and v not in listed]
    rows = [told("splats that may win", len(splats))]
    for splat in listed:
        rows += _splat(where, splat, at, device)
    rows.append(told("winner (-1 none)", reference, port))
    rows.append(_overdraw(case, result.least, result.most, handed, at))
    if "raster.depth" in handed:
        rows.append(_depth(result, reference if port is None else port, np.asarray(handed["raster.depth"])[at]))
    shown = reference if port is None or not 0 <= port < len(points.rows) else port
    if shown >= 0:
        one = alone(points, shown)
        own = np.asarray(handed["vertex.color"])[shown] if "vertex.color" in handed else None
        rows += colored(case, device, one, placed(case, device, one), own)
    if "color" in handed:
        rows.append(_shown("picture: colour", case.frame.color[at], np.asarray(handed["color"])[at]))
    if "depth" in handed:
        rows.append(_shown("picture: depth", case.frame.depth[at], np.asarray(handed["depth"])[at]))
    return rows


def _splat(where: Landed, splat: int, at: tuple[int, int], device: Device) -> list[TraceRow]:
    """Its borders, as distances from the pixel's centre: positive inside."""
    name = f"splat {splat}"
    if not where.possible[splat] or not np.isfinite(where.width.value[splat]):
        return [told(f"{name}: drawn", "no")]
    one = np.array([splat])
    rows = []
    for label, center, index in (("x", where.x, at[1]), ("y", where.y, at[0])):
        width = where.width[one]
        spans = axis(center[one], width, 2**30)
        half, bound = (
            float(width.value[0]) / 2.0,
            float((width.error / 2.0 + border(spans.reference, width, device))[0]),
        )
        bound += float(max(spans.high[0] - spans.reference[0], spans.reference[0] - spans.low[0])) - device.splat_border
        first, last = float(spans.reference[0]) - half, float(spans.reference[0]) + half
        low, high = index + 0.5 - first, last - (index + 0.5)
        rows.append(compared(f"{name}: {label} >= {first:.9g}", low >= 0.0, low, bound))
        rows.append(compared(f"{name}: {label} < {last:.9g}", high > 0.0, high, bound))
    depth: Bounded = buffered(where.depth)
    return [*rows, number(f"{name}: depth", [depth[splat]])]


def _overdraw(case: Case, least: np.ndarray, most: np.ndarray, handed: Handed, at: tuple[int, int]) -> TraceRow:
    place = at[0] * case.scene.camera.width + at[1]
    port = np.asarray(handed["raster.overdraw"])[at] if "raster.overdraw" in handed else None
    legal = port is None or least[place] <= port <= most[place]
    reference = f"{case.frame.stages['raster.overdraw'][at]} (from {least[place]} to {most[place]})"
    return TraceRow(
        step="overdraw", reference=reference, port="" if port is None else str(port), note="" if legal else DIFFERS
    )


def _depth(result: Contest, splat: int, port: np.ndarray) -> TraceRow:
    """The depth buffer, against the depth of the splat that the port shows."""
    if not 0 <= splat < len(result.depth.value):
        return told("depth buffer", text(1.0), text(port))
    return number("depth buffer", [result.depth[splat]], port)


def _shown(step: str, reference: np.ndarray, port: np.ndarray) -> TraceRow:
    mine = f"{text(reference)} = {text(255.0 * reference)} / 255" if np.ndim(reference) else text(reference)
    return TraceRow(step=step, reference=mine, port=text(port))
