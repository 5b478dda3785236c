"""Ports of splatting with one bug each."""

from ibr_ref.oracle.ports.splatting.mutants import atlas, geometry, law, lighting, normals, raster, resolve

MUTANTS = (
    *normals.MUTANTS,
    *atlas.MUTANTS,
    *geometry.MUTANTS,
    *law.MUTANTS,
    *lighting.MUTANTS,
    *raster.MUTANTS,
    *resolve.MUTANTS,
)

__all__ = ["MUTANTS"]
