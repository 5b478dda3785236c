"""Splatting, as someone ports it who has read its page: the stages, in order."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ibr_ref.oracle.arithmetic.device import Arithmetic, Policy
from ibr_ref.oracle.ports.splatting.atlas import Atlas
from ibr_ref.oracle.ports.splatting.normals import Normals
from ibr_ref.oracle.ports.splatting.raster import Raster
from ibr_ref.oracle.ports.splatting.resolve import Resolve
from ibr_ref.oracle.ports.splatting.stage import Stage
from ibr_ref.oracle.ports.splatting.vertex import Vertex


class Port:
    """Other ports put a class of their own in the place of one of the five."""

    normals: ClassVar[type[Normals]] = Normals
    atlas: ClassVar[type[Atlas]] = Atlas
    vertex: ClassVar[type[Vertex]] = Vertex
    raster: ClassVar[type[Raster]] = Raster
    resolve: ClassVar[type[Resolve]] = Resolve

    def __init__(self, scene: Any, params: Any, policy: Policy, inputs: dict[str, Any]) -> None:
        """The case; inputs["normals"]: codes (H, W, 3) uint8, one array an image, to light with. Without: the port's own."""
        self.scene = scene
        self.params = params
        self.policy = policy
        self.inputs = inputs

    def render(self) -> dict[str, Any]:
        """All arrays of the contract but for `raster.margin`; those of the atlas are tuples, one array a page."""
        with np.errstate(all="ignore"):  # a device knows no traps
            return self._arrays(Arithmetic(self.policy), self.scene, self.params)

    def _arrays(self, *context: Any) -> dict[str, Any]:
        codes = [self.normals(*context).codes(image) for image in self.scene.images]
        atlas = self.atlas(*context).arrays(codes)
        vertices = self.vertex(*context).arrays(atlas, self.inputs.get("normals", codes))
        raster = self.raster(*context).arrays(vertices)
        color = self.resolve(*context).color(vertices, raster["raster.splat"])
        return {**atlas, **vertices, **raster, "color": color, "depth": raster["raster.depth"]}


_STAGES: dict[str, type[Stage]] = {
    "normals": Normals,
    "atlas": Atlas,
    "vertex": Vertex,
    "raster": Raster,
    "resolve": Resolve,
}


def replaced_stage(stage: type[Stage]) -> str:
    """The name of the stage that a class takes the place of."""
    return next(name for name, standard in _STAGES.items() if issubclass(stage, standard))


def with_stage(stage: type[Stage]) -> type[Port]:
    """The port with one stage replaced."""
    return type(stage.__name__, (Port,), {replaced_stage(stage): stage})
