"""A device that draws what programs of shadows ask for as a whole: maps of the caster, and meshes of control points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.pipeline.machine import Machine
from ibr_ref.oracle.programs.shadows import Port as Program
from ibr_ref.oracle.programs.shadows.raster import Raster
from ibr_ref.oracle.referees.shadows.maps import hull
from ibr_ref.oracle.referees.shadows.model import Model
from ibr_ref.oracle.referees.shadows.warp import Mesh, mesh_of


class Drawing(Machine):
    """Its rasterizer is not a program's own."""

    def __init__(self, model: Model) -> None:
        """A fault may take the device for another one."""
        self.model = model
        self._drawn: tuple[Number, Mesh] | None = None
        super().__init__(replace(model.device, **model.kind.limits))

    def caster_map(self, program: Program, raster: Raster, clip: Sequence[Any]) -> Number:
        """(S, S) all that texels may be."""
        return self.model.number(hull(self.model, raster, clip))

    def warped(self, program: Program, image: Number, source: Number, target: Number) -> Number:
        """(S, S) an image redrawn from one grid to another."""
        if (
            self._drawn is None or self._drawn[0] is not target
        ):  # two images are warped to one grid, one after the other
            self._drawn = target, mesh_of(self.model, target, len(image))
        return self.model.number(self._drawn[1].warped(image, source))


def model_of(case: Case, device: Device, kind: type[Program] = Program) -> Model:
    """A program on a device."""
    return Model(case, device, kind, Drawing)
