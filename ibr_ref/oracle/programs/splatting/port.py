"""Splatting, as someone ports it who has read its page: the stages, in order."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ibr_ref.oracle.programs.splatting.atlas import Atlas
from ibr_ref.oracle.programs.splatting.case import Floats
from ibr_ref.oracle.programs.splatting.ellipses import Ellipses, Footprints
from ibr_ref.oracle.programs.splatting.normals import Preparation
from ibr_ref.oracle.programs.splatting.resolve import Resolve


class Port(Atlas, Footprints, Ellipses, Resolve):
    """Atlas, vertex, raster and resolve, after a preparation of normals that is a program of its own. A `PlainPort`.

    inputs["normals"]: codes (H, W, 3) uint8, one array an image, to light with. Without: the port's own.
    """

    preparation: ClassVar[type[Preparation]] = Preparation

    def render(self) -> dict[str, Any]:
        """All arrays of the contract but for `raster.margin`; those of the atlas are tuples, one array a page."""
        with np.errstate(all="ignore"):  # a device knows no traps
            prepared = self.preparation(self.scene, self.params, self.do.policy, {})
            codes = [prepared.codes(image) for image in self.scene.images]
            atlas = {**self.atlas(), "atlas.normal": self.pages(self.places(), codes)}
            vertices = self.vertices(atlas, self.inputs.get("normals", codes))
            raster = self.raster(vertices)
            raster, color = self.shaded_picture(vertices, raster)
        return {**atlas, **vertices, **raster, "color": color, "depth": raster["raster.depth"]}

    def vertices(self, atlas: dict[str, Any], codes: Any) -> dict[str, Any]:
        """The vertex stage's arrays, of the atlas' and the normals (H, W, 3) to light with, one array an image."""
        parts = [self.points(i, self.texels(i, atlas, codes[i])) for i in range(len(self.scene.images))]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def shaded_picture(self, vertices: dict[str, Any], raster: dict[str, Any]) -> tuple[dict[str, Any], Floats]:
        """The raster stage's arrays, with the sums over ellipses, and the picture (H, W, 3)."""
        winner = raster["raster.splat"]
        if not self.elliptic:
            return raster, self.resolve(vertices["vertex.color"], winner)
        sums = self.second_pass(vertices, winner)
        raster = {**raster, "raster.weight": sums.weight.reshape(winner.shape)}
        raster["raster.blended"] = sums.blended.reshape(winner.shape)
        return raster, self.averages(sums.color, raster["raster.weight"])

    def averages(self, color: Floats, weight: Floats) -> Floats:
        """(H, W, 3), of the averages (P, 3) and what they are divided by (H, W): a pixel shows its own."""
        own = np.arange(weight.size).reshape(weight.shape)
        return self.resolve(color, np.where(weight > 0.0, own, -1))
