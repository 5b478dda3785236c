"""Replay: each stage fed with the port's own arrays of the stages before, and what it hands on.

What a port did not hand in is the program's, as far as it agrees with what it did: of all legal outcomes those that the
port's arrays fit stay, with the port's numbers in place of theirs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import Handed
from ibr_ref.oracle.programs.displacement.vertex import Quad
from ibr_ref.oracle.referees.displacement.hits import points_from, points_of, redepthed
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.picture import Picture, picture_of
from ibr_ref.oracle.referees.displacement.rows import Hits, Points, Shades, Vector
from ibr_ref.oracle.referees.outcomes import stored

ARRAYS = {
    "vertex": ("vertex.patch", "vertex.clip"),
    "raster": ("raster.face", "raster.patch_id", "raster.patch"),
    "march": ("march.linear_index", "march.hit_index", "march.hit", "march.height_before", "march.steep"),
    "shade": ("shade.albedo", "shade.normal", "shade.lit"),
}
"""What is compared in each stage, in order of computation; besides, in shade the colours of what is shown, and in resolve
depth and background."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Port:
    """A port's arrays, one row a pixel, with the program that they are judged by."""

    model: Model
    handed: Handed
    among: Bools | None = None
    """(pixels,) those that are judged; None: all."""

    @property
    def case(self) -> Any:
        """Which it answers."""
        return self.model.case

    @property
    def pixels(self) -> int:
        """Of the picture."""
        camera = self.case.scene.camera
        return int(camera.width * camera.height)

    @property
    def polygons(self) -> int:
        """Of the scene."""
        return len(self.model.patches)

    @cached_property
    def picture(self) -> Picture:
        """What the case alone allows; of the right program it is computed once."""
        return picture_of(self.case, self.model.device, self.model.kind, self.among)

    @cached_property
    def own_points(self) -> Points:
        """The candidates of the program's own vertices."""
        return points_of(self.model)

    def names(self, stage: str) -> tuple[str, ...]:
        """The stage's arrays that were handed in."""
        return tuple(name for name in ARRAYS[stage] if name in self.handed)

    def has(self, *names: str) -> bool:
        """Whether all of them were handed in."""
        return all(name in self.handed for name in names)

    @property
    def whole_hits(self) -> bool:
        """Whether the port's own hits are all that shading needs."""
        return self.has("march.hit_index", "march.hit", "march.steep") and (
            "raster.patch_id" in self.handed or self.polygons == 1
        )

    def floats(self, name: str) -> Floats:
        """(pixels,) or (pixels, 3)."""
        return np.asarray(self._rows(np.asarray(self.handed[name])), np.float64)

    def ints(self, name: str) -> Ints:
        """(pixels,)."""
        return np.asarray(self._rows(np.asarray(self.handed[name])), np.int64)

    def vector(self, name: str, at: Ints) -> Vector:
        """The port's own numbers at pixels."""
        return [self.stored(x) for x in self.floats(name)[at].T]

    def stored(self, values: Floats, own: Number | None = None) -> Number:
        """What was handed in, as the port computed with it."""
        return stored(self.model.machine, values, own)

    def polygon(self, at: Any = slice(None)) -> Ints:
        """Of each pixel, by the port's own account; -1 where it names none of the scene's."""
        written = self.ints("raster.patch_id")[at]
        result = np.full(len(written), -1)
        for number, name in enumerate(self.model.patch_number(np.arange(self.polygons))):
            result[written == name] = number
        return result

    def _rows(self, array: Any) -> Any:
        return array.reshape(self.pixels, *array.shape[2:])

    def agreement(self, name: str, pixel: Ints, legal: Any) -> Bools:
        """Whether the port's numbers at pixels are those of an outcome."""
        if isinstance(legal, list):
            found = self.floats(name)[pixel]
            return np.asarray(np.all([x.allows(found[:, k]) for k, x in enumerate(legal)], axis=0), np.bool_)
        if isinstance(legal, Number):
            return legal.allows(self.floats(name)[pixel])
        return np.asarray(self.ints(name)[pixel] == legal, np.bool_)


def raster_input(port: Port) -> tuple[Points, tuple[str, ...]]:
    """The candidates of the port's own vertices, where it has as many as the program."""
    quads = port.model.quads
    count = sum(4 * len(each) for each in quads)
    names = port.names("vertex")
    if not names or any(len(port.handed[name]) != count for name in names):
        return port.own_points, ()
    legal = port.model.vertices
    clip, patch = (
        port.stored(np.asarray(port.handed[name], np.float64), legal[name]) if name in names else legal[name]
        for name in ("vertex.clip", "vertex.patch")
    )
    own, first = [], 0
    for each in quads:
        row = []
        for quad in each:
            rows = slice(first, first + 4)
            row.append(Quad(quad.face, patch[rows], clip[rows]))
            first += 4
        own.append(row)
    with np.errstate(all="ignore"):  # a port's vertices may be anything
        return points_from(port.model, own), names


def march_input(port: Port, candidates: Points) -> tuple[Points, Bools]:
    """The fragments that the port marched from, and the pixels without one."""
    names = port.names("raster")
    if len(names) == len(ARRAYS["raster"]):
        face, polygon, point = port.ints(names[0]), port.polygon(), port.floats(names[2])
        usable = (face >= 0) & (face <= 5) & (polygon >= 0)
        pixel = np.flatnonzero(usable & np.isfinite(point).all(axis=1))
        return Points(
            pixel=pixel,
            polygon=polygon[pixel],
            face=face[pixel],
            certain=np.ones(len(pixel), np.bool_),
            point=port.vector(names[2], pixel),
            depth=_face_depth(candidates, pixel, polygon[pixel], face[pixel]),
        ), face < 0
    agrees = np.ones(len(candidates), np.bool_)
    for name in names:
        agrees &= port.agreement(name, candidates.pixel, raster_field(port, candidates, name))
    points = candidates.take(agrees)
    if "raster.patch" in names:
        own = port.floats("raster.patch")[points.pixel]
        points = replace(points, point=[port.stored(own[:, k], x) for k, x in enumerate(points.point)])
    if "raster.face" in names:
        return points, port.ints("raster.face") < 0
    return points, not_covered(candidates, port.pixels)


def _face_depth(known: Points | Hits, pixel: Ints, polygon: Ints, face: Ints | None) -> Number:
    """Window depth of the faces, all that their candidates may have; unknown where there is no such candidate.

    Without a face: of any of that polygon at the pixel. A face that the near plane cuts may have several triangles there.
    """

    def keys(p: Ints, q: Ints, f: Ints | None) -> Ints:
        return (p * (int(known.polygon.max(initial=0)) + 1) + q) * 6 + (0 if f is None else f)

    value, error = np.zeros(len(pixel)), np.full(len(pixel), np.inf)
    if len(known):
        have = keys(known.pixel, known.polygon, None if face is None else known.face)
        order = np.argsort(have, kind="stable")
        names, first = np.unique(have[order], return_index=True)
        wanted = keys(pixel, polygon, face)
        at = np.minimum(np.searchsorted(names, wanted), len(names) - 1)
        found = names[at] == wanted
        depth = known.depth[order]
        low, high = np.minimum.reduceat(depth.low, first), np.maximum.reduceat(depth.high, first)
        middle = depth.value[first]
        value[found], error[found] = middle[at[found]], np.maximum(high - middle, middle - low)[at[found]]
    return Number(known.depth.do, value, error)


def raster_field(port: Port, points: Points, name: str) -> Any:
    """What the contract's array holds of the candidates."""
    if name == "raster.patch_id":
        return port.model.patch_number(points.polygon)
    return points.face if name == "raster.face" else points.point


def not_covered(candidates: Points, pixels: int) -> Bools:
    """(pixels,) which may have no fragment at all."""
    result = np.ones(pixels, np.bool_)
    result[candidates.pixel[candidates.certain]] = False
    return result


def shade_input(port: Port, hits: Hits | None, candidates: Callable[[], Points]) -> Hits:
    """The hits that the port shaded; the program's outcomes are needed where the port's are not all there.

    candidates: those of the port's vertices, where faces' depths hang on them.
    """
    names = port.names("march")
    if port.whole_hits:
        return _ports_hits(port, candidates)
    assert hits is not None
    agrees = np.ones(len(hits), np.bool_)
    for name in names:
        agrees &= port.agreement(name, hits.pixel, march_field(hits, name))
    hits = hits.take(agrees & hits.kept)
    return _at(port, hits) if "march.hit" in names else hits


def march_field(hits: Hits, name: str) -> Any:
    """What the contract's array holds of the outcomes."""
    return getattr(hits, name.partition(".")[2])


def _ports_hits(port: Port, candidates: Callable[[], Points]) -> Hits:
    index, point = port.ints("march.hit_index"), port.floats("march.hit")
    several = "raster.patch_id" in port.handed
    polygon = port.polygon() if several else np.zeros(port.pixels, np.int64)
    usable = (index >= 0) & np.isfinite(point).all(axis=1) & (polygon >= 0)
    pixel = np.flatnonzero(usable if port.among is None else usable & port.among)
    count = len(pixel)
    zero = np.zeros(count, np.int64)
    none = Number(port.model.machine, np.zeros(count))
    face_depth = none
    if not port.model.program.right("window_depth") or not port.model.program.displaces:
        face_depth = _face_depth(candidates(), pixel, polygon[pixel], None)
    return _at(
        port,
        Hits(
            pixel=pixel,
            polygon=polygon[pixel],
            face=zero,
            certain=np.ones(count, np.bool_),
            point=[none] * 3,
            linear_index=zero,
            hit_index=index[pixel],
            hit=[none] * 3,
            height_before=none,
            steep=port.ints("march.steep")[pixel] != 0,
            depth=face_depth,
        ),
    )


def _at(port: Port, hits: Hits) -> Hits:
    """The hits at the port's own points, with the depths that belong to them."""
    hits = replace(hits, hit=port.vector("march.hit", hits.pixel))
    return replace(hits, depth=redepthed(port.model, hits)) if len(hits) else hits


def light_input(port: Port, hits: Hits, shades: Shades | None) -> Shades:
    """The surfaces that the port lit; the program's looks are needed where the port's are not all there."""
    names = port.names("shade")
    if len(names) == len(ARRAYS["shade"]):
        albedo, normal = port.floats("shade.albedo"), port.floats("shade.normal")
        usable = np.isfinite(albedo[hits.pixel]).all(axis=1) & np.isfinite(normal[hits.pixel]).all(axis=1)
        index = np.flatnonzero(usable & hits.kept)
        pixel = hits.pixel[index]
        return Shades(
            pixel=pixel,
            hit=index,
            albedo=port.vector("shade.albedo", pixel),
            normal=port.vector("shade.normal", pixel),
            lit=port.ints("shade.lit")[pixel] != 0,
        )
    assert shades is not None
    agrees = np.ones(len(shades), np.bool_)
    for name in names:
        agrees &= port.agreement(name, shades.pixel, shade_field(shades, name))
    shades = shades.take(agrees)
    for field in ("albedo", "normal"):
        if f"shade.{field}" in names:
            change: dict[str, Any] = {field: port.vector(f"shade.{field}", shades.pixel)}
            shades = replace(shades, **change)
    return shades


def shade_field(shades: Shades, name: str) -> Any:
    """What the contract's array holds of the shades."""
    return getattr(shades, name.partition(".")[2])
