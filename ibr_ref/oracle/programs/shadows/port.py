"""Shadows by image warping as someone ports it from the page alone: all stages in order."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.programs.program import Floats, Vector
from ibr_ref.oracle.programs.shadows.grid import Grid
from ibr_ref.oracle.programs.shadows.resolve import Resolve
from ibr_ref.oracle.programs.shadows.soft import Soft
from ibr_ref.oracle.programs.shadows.surface import Picture, Surface
from ibr_ref.oracle.programs.shadows.warp import Warp, Warped

Arrays = dict[str, NDArray[Any]]


class Port(Picture, Warp, Grid, Soft, Resolve):
    """Methods "warp", "direct", "grid" and "pcss". For "warp", inputs["maps"] are the nine maps and their controls."""

    def render(self) -> Arrays:
        """Every stage array of the contract but the margins, "color" (H, W, 3) and "depth" (H, W)."""
        arrays, images = self._maps()
        surface = self.surface()
        if self.soft:
            return arrays | self._softened(surface, images[0])
        coords, shadows = zip(
            *(self._on_picture(surface, *pair) for pair in zip(self.places, images, strict=True)), strict=True
        )
        arrays |= {"project.coord": self._samples(list(coords)), "project.shadow": self._samples(list(shadows))}
        return arrays | self._picture(surface, list(shadows))

    def _softened(self, surface: Surface, image: Floats) -> Arrays:
        """All arrays from project on, of one map."""
        at = self.coordinates(surface.world, self.places[0])
        blocker, penumbra, shadow = (self._spread(surface, x) for x in self.softened(image, at, surface.casts))
        found = {"project.coord": self._spread(surface, np.stack(at[:3], axis=-1)), "project.shadow": shadow}
        found |= {"project.blocker": blocker, "project.penumbra": penumbra}
        return found | self._picture(surface, [shadow])

    def _picture(self, surface: Surface, shadows: list[Floats]) -> Arrays:
        """The sum of all samples, colour and depth."""
        total = self.accumulated(shadows)
        depth = self.read_back(surface.depth.reshape(self._size))
        return {"accumulate.shadow": total, "color": self._color(surface, total), "depth": depth}

    def _spread(self, surface: Surface, found: Floats) -> Floats:
        """(H, W, ...) of fragments; 0 where nothing is seen."""
        spread = np.zeros((*self._size, *found.shape[1:]))
        spread.reshape(-1, *found.shape[1:])[surface.pixel] = found
        return spread

    @property
    def _size(self) -> tuple[int, int]:
        return self.scene.camera.height, self.scene.camera.width

    def _samples(self, arrays: list[NDArray[Any]]) -> NDArray[Any]:
        """One array, with a leading axis where there are several samples of the light."""
        return np.stack(arrays) if len(arrays) > 1 else arrays[0]

    def _maps(self) -> tuple[Arrays, list[Floats]]:
        """The arrays up to the warp, and the map of each sample."""
        if self.params.method != "warp":
            images = [self.sample_map(place) for place in self.places]
            return {"warp.image": self._samples(images)}, images
        positions, controls, prepared = self.positions(), self.controls(), self.images()
        arrays: Arrays = {"maps.positions": positions, "maps.image": self.nine_maps(positions), "controls": controls}
        lines = self.lines()
        warps = [self.warped(place, controls, prepared, lines) for place in self.places]
        if self.projective:
            arrays["maps.depths"] = self.caster_depths(lines)
        for name in Warped.__dataclass_fields__:
            if name == "shares" and not self.projective:
                continue
            arrays[f"warp.{name}"] = self._samples([getattr(warp, name) for warp in warps])
        return arrays, [warp.image for warp in warps]

    def sample_map(self, place: Floats) -> Floats:
        """(S, S) of a sample, where nothing is warped."""
        if self.soft:
            return self.soft_map()
        return self.direct_map(place) if self.params.method == "direct" else self.grid_map(place)

    def sample_clip(self, place: Floats) -> Vector:
        """Of the caster in the map of a sample that is rendered alone."""
        return self.soft_clip() if self.soft else self.direct_clip(place)

    def _on_picture(self, surface: Surface, place: Floats, image: Floats) -> tuple[Floats, Floats]:
        """coord (H, W, 3) and shadow (H, W) of one sample."""
        coord, shadow = self.projected(surface, place, image)
        return self._spread(surface, coord), self._spread(surface, shadow)

    def _color(self, surface: Surface, shadow: Floats) -> Floats:
        """(H, W, 3)."""
        height, width = self._size
        colors = np.broadcast_to(self.background(), (height * width, 3)).copy()
        colors[surface.pixel] = np.stack(self.resolved(surface, shadow.reshape(-1)[surface.pixel]), axis=-1)
        return self.turned_rows(self.written(self.do.color(colors.reshape(height, width, 3))))
