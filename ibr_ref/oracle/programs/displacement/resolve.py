"""Resolve: window depth, depth test, colour write; and the arrays that are handed in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement.contract import STAGES
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import Hits
from ibr_ref.oracle.programs.displacement.raster import Fragments
from ibr_ref.oracle.programs.displacement.shade import Shaded
from ibr_ref.oracle.programs.displacement.vertex import Vertex


@dataclass(frozen=True)
class Drawn:
    """All fragments of one patch, after shading."""

    patch: Patch
    fragments: Fragments
    hits: Hits
    shaded: Shaded


class Resolve(Vertex):
    """From fragments to the picture."""

    def resolve(self, drawn: Sequence[Drawn]) -> dict[str, NDArray[np.generic]]:
        """The stage arrays of the picture's size, colour and depth."""
        pixel = np.concatenate([d.fragments.row * self.width + d.fragments.column for d in drawn])
        triangle = np.concatenate([d.fragments.triangle for d in drawn])
        kept = np.concatenate([d.hits.hit_index >= 0 for d in drawn])
        depths = np.concatenate([self.window_depth(d.patch, d.hits.point, d.fragments.depth) for d in drawn])
        depths = np.where(kept, depths, np.nan)
        shown, first, depth = self.tested(pixel, triangle, kept, depths)
        chosen = np.where(shown >= 0, shown, first)
        size = (self.height, self.width)
        arrays = {
            name: self.gathered(values, chosen, STAGES[name].blank).reshape(*size, *values.shape[1:])
            for name, values in self.stage_values(drawn).items()
        }
        colors = np.concatenate([np.stack(d.shaded.color, axis=-1) for d in drawn])
        color = self.gathered(colors, shown, self.background()).reshape(*size, 3)
        return {**arrays, "color": self.rows(self.written(color)), "depth": depth.reshape(size)}

    def stage_values(self, drawn: Sequence[Drawn]) -> dict[str, NDArray[Any]]:
        """What the fragments carry, by the names of the contract."""
        values: dict[str, list[NDArray[Any]]] = {}
        for d in drawn:
            count = len(d.fragments.face)
            for name, array in (
                ("raster.face", d.fragments.face.astype(np.int32)),
                ("raster.patch_id", np.full(count, self.patch_number(d.patch), np.int32)),
                ("raster.patch", self.stacked(d.fragments.point)),
                ("march.linear_index", d.hits.linear_index.astype(np.int32)),
                ("march.hit_index", d.hits.hit_index.astype(np.int32)),
                ("march.hit", self.stacked(d.hits.point)),
                ("march.height_before", d.hits.height_before),
                ("march.steep", d.hits.steep),
                ("shade.albedo", self.stacked(d.shaded.albedo)),
                ("shade.normal", self.stacked(d.shaded.normal)),
                ("shade.lit", d.shaded.lit),
            ):
                values.setdefault(name, []).append(array)
        return {name: np.concatenate(parts) for name, parts in values.items()}

    def stacked(self, vector: Vector) -> Floats:
        """(F, 3)."""
        return np.stack(vector, axis=-1)

    def patch_number(self, patch: Patch) -> int:
        """The patch's number as it is written."""
        return patch.number

    def gathered(self, values: NDArray[Any], which: Ints, nothing: Any) -> NDArray[Any]:
        """One fragment's value for each pixel."""
        result = np.empty((len(which), *values.shape[1:]), values.dtype)
        result[:] = nothing
        result[which >= 0] = values[which[which >= 0]]
        return result

    # --- Depth -------------------------------------------------------------------------------------------------------

    def window_depth(self, patch: Patch, hit: Vector, face_depth: Floats) -> Floats:
        """The fragments' depths as the depth buffer holds them."""
        return self.do.depth(self.hit_depth(patch, hit) if self.displaces else face_depth)

    @property
    def displaces(self) -> bool:
        """Whether depth is that of the hit, and not of the face."""
        return bool(self.params.depth == "displaced")

    def hit_depth(self, patch: Patch, hit: Vector) -> Floats:
        """Window depth of hits."""
        _, _, z, w = self.projected(patch, hit)
        return self.do.divide(z, w)

    def tested(self, pixel: Ints, triangle: Ints, kept: Bools, depths: Floats) -> tuple[Ints, Ints, Floats]:
        """Each pixel's fragment that is shown, the first that covers it (-1: none), and the depth buffer."""
        shown, first = np.full((2, self.height * self.width), -1)
        buffer = np.ones(self.height * self.width)
        ends = np.flatnonzero(np.diff(triangle, append=-1)) + 1
        for fragments in np.split(np.arange(len(pixel)), ends[:-1]):
            here = pixel[fragments]
            first[here] = np.where(first[here] < 0, fragments, first[here])
            passes = self.writes_depth(kept[fragments]) & self.nearer(depths[fragments], buffer[here])
            buffer[here[passes]] = depths[fragments[passes]]
            shown[here[passes]] = fragments[passes]
        return shown, first, buffer

    def writes_depth(self, kept: Bools) -> Bools:
        """Discarded fragments leave no trace."""
        return kept

    def nearer(self, new: Floats, old: Floats) -> Bools:
        """The depth test, LESS."""
        return new < old

    # --- Colour ------------------------------------------------------------------------------------------------------

    def background(self) -> Floats:
        """(3,)."""
        return self.do.number(self.scene.background)

    def rows(self, picture: NDArray[Any]) -> NDArray[Any]:
        """The colour buffer (H, W, 3) as it is handed in: from the top. A fault's is its own inverse."""
        return picture

    def written(self, color: Floats) -> Floats:
        """As the frame buffer holds it."""
        return self.do.color(color)
