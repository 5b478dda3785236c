"""Which trace belongs to which stage."""

from __future__ import annotations

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.referees.splatting.trace.pixels import pixel
from ibr_ref.oracle.referees.splatting.trace.points import point
from ibr_ref.oracle.referees.splatting.trace.texels import atlas_texel, normal_texel


def trace(case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
    """Rows of one element; index: (vertex,), (row, column) of a pixel, or (texel,) in the order of its judgement.

    Raises ValueError for a stage that the method has not.
    """
    if stage == "normals":
        return normal_texel(case, device, handed, index[0])
    if stage == "atlas":
        return atlas_texel(case, device, handed, index[0])
    if stage == "vertex":
        return point(case, device, handed, index[0])
    if stage in ("raster", "resolve", "image"):
        return pixel(case, device, {} if stage == "image" else handed, handed, (index[0], index[1]))
    raise ValueError(f"stage: found {stage!r}, allowed: normals | atlas | vertex | raster | resolve | image")
