"""A pixel's own numbers, array by array, beside those of the outcome that they are nearest to: what heads a witness."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Ints
from ibr_ref.displacement.contract import STAGES
from ibr_ref.oracle.accept.bounded import Bounded, exact
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import TraceRow
from ibr_ref.oracle.referees import rows
from ibr_ref.oracle.referees.displacement.hits import lighted, shades_of
from ibr_ref.oracle.referees.displacement.replay import (
    ARRAYS,
    Port,
    light_input,
    march_field,
    raster_field,
    shade_field,
)
from ibr_ref.oracle.referees.displacement.rows import Hits, Points

Field = Bounded | Ints | Bools


def bounded(field: Any) -> Any:
    """Numbers and vectors with their bounds, arrays as they are."""
    if isinstance(field, list):
        parts = [bounded(x) for x in field]
        value, error = (np.stack(get, axis=-1) for get in zip(*((p.value, p.error) for p in parts), strict=True))
        return Bounded(value, error, parts[0].device)
    if isinstance(field, Number):
        return Bounded(field.value, np.broadcast_to(field.deviation, field.shape), field.do.device)
    return field


@dataclass(frozen=True)
class Element:
    """A pixel of a port."""

    port: Port
    pixel: int

    def raster(self, candidates: Points) -> list[TraceRow]:
        """Face, polygon and point."""
        fields = {name: bounded(raster_field(self.port, candidates, name)) for name in ARRAYS["raster"]}
        bare = not candidates.certain.any()
        return self._rows(fields, self._likeliest(fields, ("raster.face", "raster.patch_id")), bare)

    def march(self, hits: Hits) -> list[TraceRow]:
        """Indices, hit, height and steepness."""
        fields = {name: bounded(march_field(hits, name)) for name in ARRAYS["march"]}
        likeliest = self._likeliest(fields, ("march.hit_index", "march.steep", "march.linear_index"))
        return self._rows(fields, likeliest, not len(hits))

    def shade(self, hits: Hits) -> list[TraceRow]:
        """Albedo, normal and light, and the colour of that."""
        shades, _ = shades_of(self.port.model, hits)
        fields = {name: bounded(shade_field(shades, name)) for name in ARRAYS["shade"]}
        found = self._rows(fields, self._likeliest(fields, ("shade.lit",)), not len(shades))
        surfaces = light_input(self.port, hits, shades)
        _, color, _ = lighted(self.port.model, hits, surfaces)
        return found + self._colors(bounded(color))

    def resolve(self, hits: Hits) -> list[TraceRow]:
        """Depth, and the background where nothing is kept; the colour has been told with shade."""
        kept = hits.take(hits.kept)
        one = exact(np.ones(1), self.port.model.device)
        depth = bounded(kept.depth) if len(kept) else one
        rows_ = self._rows({"depth": depth}, 0, bare=False)
        return rows_ if len(kept) else [*rows_, *self._colors(self._background)]

    def image(self) -> list[TraceRow]:
        """What the reference shows, beside what the port does."""
        frame, at = self.port.case.frame, self._at
        looks = self.port.picture.all
        looks = looks.take((looks.pixel == self.pixel) & self.port.picture.shown(looks))
        color, depth, device = bounded(looks.color), bounded(looks.depth), self.port.model.device
        result = []
        if self.port.has("depth"):
            found = float(np.asarray(self.port.handed["depth"])[at])
            row = rows.number("picture: depth", exact(frame.depth[at], device), found, array="depth")
            result.append(replace(row, note="" if bool(depth.allows(found).any()) else rows.DIFFERS, bound=None))
        if self.port.has("color"):
            found_color = np.asarray(self.port.handed["color"])[at]
            legal = bool(allows_color(color, found_color).all(axis=1).any())
            bounds = [exact(c, device) for c in frame.color[at]]
            result.append(replace(rows.color("picture: colour", bounds, found_color, legal), bound=None))
        return result

    @property
    def _at(self) -> tuple[int, int]:
        row, column = divmod(self.pixel, int(self.port.case.scene.camera.width))
        return row, column

    @property
    def _background(self) -> Bounded:
        behind: Bounded = bounded([x[None] for x in self.port.model.background])
        return behind

    def _colors(self, color: Bounded) -> list[TraceRow]:
        if not self.port.has("color") or not len(color.value):
            return []
        found = np.asarray(self.port.handed["color"])[self._at]
        legal: Bools = np.all(allows_color(color, found), axis=1)
        first = int(np.argmax(legal))
        bounds = [color[first, k] for k in range(3)]
        return [rows.color("colour", bounds, found, bool(legal[first]))]

    def _likeliest(self, fields: Mapping[str, Field], names: Sequence[str]) -> int:
        """Of the outcomes the one that the reference's frame has, if it is among them, else the first."""
        stages = self.port.case.frame.stages
        same: Bools = np.ones(len(next(iter(_values(f) for f in fields.values()))), np.bool_)
        for name in names:
            closer = same & (_values(fields[name]) == stages[name][self._at])
            same = closer if closer.any() else same
        return int(np.argmax(same)) if len(same) else 0

    def _rows(self, fields: Mapping[str, Field], likeliest: int, bare: bool) -> list[TraceRow]:
        """A row for each array that was handed in, beside the outcome that most of them agree with, from the first on.

        bare: there may be nothing, and the reference has nothing.
        """
        names = [name for name in fields if name in self.port.handed]
        if not names:
            return []
        count = len(_values(fields[names[0]]))
        at = np.full(count, self.pixel)
        agrees = {name: self._agrees(name, at, fields[name]) for name in names}
        left, chosen = np.ones(count, np.bool_), likeliest
        for name in names:
            if not (left & agrees[name]).any():
                break
            left &= agrees[name]
            chosen = likeliest if left[likeliest] else int(np.argmax(left))
        nothing = not count or (bare and not agrees[names[0]].any() and self._nothing_there)
        result = []
        for name in names:
            legal = bool(agrees[name][chosen]) if count else False
            value = np.atleast_1d(self.port.floats(name)[self.pixel]) if nothing else _values(fields[name])[chosen]
            if nothing:
                value = np.full(value.shape, STAGES[name].blank)
                legal = bool(np.array_equal(value, np.atleast_1d(self.port.floats(name)[self.pixel]), equal_nan=True))
            result.append(self._row(name, value, fields[name], legal))
        return result

    @property
    def _nothing_there(self) -> bool:
        """Whether no face covers the pixel in the reference's frame."""
        return bool(self.port.case.frame.stages["raster.face"][self._at] < 0)

    def _agrees(self, name: str, at: Ints, field: Field) -> Bools:
        if not isinstance(field, Bounded):
            return self.port.agreement(name, at, field)
        allowed = field.allows(self.port.floats(name)[at])
        return allowed if allowed.ndim == 1 else np.asarray(allowed.all(axis=1))

    def _row(self, name: str, value: NDArray[np.generic], field: Field, legal: bool) -> TraceRow:
        found = np.asarray(self.port.floats(name)[self.pixel])
        if np.asarray(self.port.handed[name]).dtype == np.bool_:
            reference, port = str(bool(np.all(value))), str(bool(found))
            return rows.told(name, reference, port, legal=legal, array=name)
        bound = float(np.max(field.error)) if isinstance(field, Bounded) and field.error.size else None
        return rows.compared_numbers(
            name, np.atleast_1d(value).astype(np.float64), np.atleast_1d(found), legal, name, None, bound
        )


def _values(field: Field) -> NDArray[np.generic]:
    return field.value if isinstance(field, Bounded) else field
