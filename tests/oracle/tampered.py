"""Ports that change one array between two stages, and go on with it: wrong there, and right from there on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.faults import displacement, shadows, splatting

Arrays = dict[str, Any]
Change = Callable[[Any], Any]


def tampered(case: Case, name: str, change: Change) -> Arrays:
    """All arrays of a plain port whose array `name` has been changed before anything reads it."""
    port = {"displacement": _Displacement, "splatting": _Splatting, "shadows": _Shadows}[case.method]
    made: Any = port(case.scene, case.params, Policy(), case.inputs)
    made.name, made.change = name, change
    return dict(made.render())


class _Change:
    name: str
    change: Change

    def _changed(self, name: str, array: Any) -> Any:
        if name != self.name:
            return array
        if isinstance(array, tuple):
            return tuple(self.change(page) for page in array)
        return self.change(array)


class _Splatting(_Change, splatting.Port):
    """Lit with its own normals."""

    def render(self) -> Arrays:
        prepared = self.preparation(self.scene, self.params, self.do.policy, {})
        codes = [prepared.codes(image) for image in self.scene.images]
        atlas = self._all({**self.atlas(), "atlas.normal": self.pages(self.places(), codes)})
        own = [atlas["atlas.normal"][p][y : y + h, x : x + w] for p, x, y, w, h in atlas["atlas.rects"].tolist()]
        vertices = self._all(self.vertices(atlas, own))
        raster = self._all(self.raster(vertices))
        raster, color = self.shaded_picture(vertices, raster)
        raster = {n: self._changed(n, a) if n in ("raster.weight", "raster.blended") else a for n, a in raster.items()}
        return {**atlas, **vertices, **raster, "color": color, "depth": raster["raster.depth"]}

    def averages(self, color: Any, weight: Any) -> Any:
        changed = self._changed("raster.weight", weight)
        with np.errstate(invalid="ignore"):
            scale = np.where(changed > 0.0, weight / changed, 1.0).reshape(-1, 1)
        return super().averages(np.minimum(color * scale, 1.0), changed)

    def _all(self, arrays: Arrays) -> Arrays:
        return {name: self._changed(name, array) for name, array in arrays.items()}


class _Shadows(_Change, shadows.Port):
    """Warps the maps that it has rendered itself."""

    def positions(self) -> Any:
        return self._changed("maps.positions", super().positions())

    def lines(self) -> Any:
        positions = self.positions()
        return [positions[0, :, 0], positions[:, 0, 1]]

    def nine_maps(self, positions: Any) -> Any:
        return self._changed("maps.image", super().nine_maps(positions))

    def images(self) -> Any:
        return self.nine_maps(self.positions())

    def controls(self) -> Any:
        return self._changed("controls", super().controls())

    def find(self, lines: Any, at: Any) -> Any:
        cell, fraction = super().find(lines, at)
        if self.name == "warp.cell":
            cell = self._changed("warp.cell", cell)
            fraction = np.array([self.fraction_in(at[k], lines[k], cell[k]) for k in range(2)])
        return cell, self._changed("warp.fraction", fraction)

    def caster_depths(self, lines: Any) -> Any:
        return self._changed("maps.depths", super().caster_depths(lines))

    def shares(self, cell: Any, fraction: Any, depths: Any) -> Any:
        return list(self._changed("warp.shares", np.stack(super().shares(cell, fraction, depths))))

    def row_grid(self, first: Any, second: Any, share: Any) -> Any:
        return self._changed("warp.row_grids", super().row_grid(first, second, share))

    def between(self, images: Any, grids: Any, grid: Any, fraction: Any) -> Any:
        return self._changed("warp.rows", super().between(images, grids, grid, fraction))

    def finished(self, rows: Any, grids: Any, grid: Any, shares: Any) -> Any:
        return self._changed("warp.image", super().between(rows, grids, grid, shares[2]))

    def final_grid(self, top: Any, bottom: Any, share: Any) -> Any:
        return self._changed("warp.grid", super().final_grid(top, bottom, share))

    def divided(self, q: Any) -> Any:
        return list(self._changed("project.coord", np.stack(super().divided(q), axis=-1)).T)

    def projected(self, surface: Any, place: Any, image: Any) -> Any:
        coord, shadow = super().projected(surface, place, image)
        return coord, self._changed("project.shadow", shadow)

    def blocker(self, image: Any, at: Any) -> Any:
        return self._changed("project.blocker", super().blocker(image, at))

    def penumbra(self, blocker: Any, r: Any) -> Any:
        return self._changed("project.penumbra", super().penumbra(blocker, r))

    def search_scale(self, r: Any) -> Any:
        return super().penumbra(self.do.number(self.nearest), r)

    def accumulated(self, shadows_: Any) -> Any:
        return self._changed("accumulate.shadow", super().accumulated(shadows_))


class _Displacement(_Change, displacement.Port):
    """Each array where it leaves its stage."""

    def quads(self, patch: Any) -> Any:
        return [
            replace(q, clip=self._changed("vertex.clip", q.clip), patch=self._changed("vertex.patch", q.patch))
            for q in super().quads(patch)
        ]

    def fragments(self, quads: Any, first_triangle: int) -> Any:
        found = super().fragments(quads, first_triangle)
        point = list(self._changed("raster.patch", np.stack(found.point, axis=-1)).T)
        return replace(found, point=point, face=self._changed("raster.face", found.face))

    def march(self, patch: Any, fragments: Any) -> Any:
        hits = super().march(patch, fragments)
        point = list(self._changed("march.hit", np.stack(hits.point, axis=-1)).T)
        index = self._changed("march.hit_index", hits.hit_index)
        return replace(hits, point=point, hit_index=index, steep=self._changed("march.steep", hits.steep))

    def color_at(self, patch: Any, u: Any, v: Any) -> Any:
        return list(self._changed("shade.albedo", np.stack(super().color_at(patch, u, v), axis=-1)).T)

    def surface_normal(self, patch: Any, hit: Any, gradient: Any) -> Any:
        return list(self._changed("shade.normal", np.stack(super().surface_normal(patch, hit, gradient), axis=-1)).T)

    def lit(self, patch: Any, hit: Any) -> Any:
        return self._changed("shade.lit", super().lit(patch, hit))
