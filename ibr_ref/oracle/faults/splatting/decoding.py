"""Bugs of the vertex stage: what normals and colours are read as, and what is handed on."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.splatting.case import Floats, Image, Ints, Vector
from ibr_ref.oracle.programs.splatting.port import Port

DECODING = Bugs("vertex")


@DECODING.add("signed-normalized-fetch")
class _SignedNormalizedFetch(Port):
    """Normals are decoded as 2 k/255 − 1."""

    def decode(self, code: Floats) -> Floats:
        return self.do.subtract(self.do.multiply(2.0, self.do.divide(code, 255.0)), 1.0)


@DECODING.add("normals-not-renormalized")
class _NormalsNotRenormalized(Port):
    """Decoded normals are used as they are, not at unit length."""

    def normal(self, codes: Vector) -> Vector:
        return [self.decode(code) for code in codes]


@DECODING.add("normal-of-the-next-pixel")
class _NormalOfTheNextPixel(Port):
    """Normals are fetched one column to the right."""

    def fetch_normals(self, codes: Any, rows: Ints, columns: Ints) -> Any:
        return super().fetch_normals(codes, rows, np.minimum(columns + 1, codes.shape[1] - 1))


@DECODING.add("no-clamp", small=True)
class _NoClamp(Port):
    """Colours above 1 are not clamped."""

    def clamped(self, channel: Floats) -> Floats:
        return channel


@DECODING.add("normals-of-half-precision", small=True)
class _NormalsOfHalfPrecision(Port):
    """Normals are kept as half floats: mediump."""

    def normal(self, codes: Vector) -> Vector:
        return [half(x) for x in super().normal(codes)]


@DECODING.add(
    "varyings-of-half-precision", small=True, hidden="far below the steps of bytes, and as often too bright as too dark"
)
class _VaryingsOfHalfPrecision(Port):
    """Colours leave the vertex stage as half floats."""

    def lit(self, image: Image, world: Vector, codes: Vector, albedo: Vector) -> Vector:
        return [half(x) for x in super().lit(image, world, codes, albedo)]


@DECODING.add("clamped-below-one", small=True)
class _ClampedBelowOne(Port):
    """Colours are clamped to 0.998, against an overflow of bytes."""

    def clamped(self, channel: Floats) -> Floats:
        return np.clip(channel, 0.0, 0.998)


@DECODING.add("albedo-decoded-from-srgb")
class _AlbedoDecodedFromSrgb(Port):
    """Stored colours are made linear, though they are linear already."""

    def lit(self, image: Image, world: Vector, codes: Vector, albedo: Vector) -> Vector:
        return super().lit(image, world, codes, [channel**2.2 for channel in albedo])


@DECODING.add("colors-encoded-in-the-shader")
class _ColorsEncodedInTheShader(Port):
    """Colours leave the vertex stage with a gamma of 2.2."""

    def clamped(self, channel: Floats) -> Floats:
        return super().clamped(channel) ** (1.0 / 2.2)


@DECODING.add("normals-of-zero-to-one")
class _NormalsOfZeroToOne(Port):
    """Normals are k/255: twice that minus one is left out."""

    def decode(self, code: Floats) -> Floats:
        return self.do.divide(code, 255.0)


@DECODING.add("normals-inwards")
class _NormalsInwards(Port):
    """Normals point into the surface."""

    def normal(self, codes: Vector) -> Vector:
        return [-x for x in super().normal(codes)]


@DECODING.add("y-and-z-of-normals-exchanged")
class _NormalsOfAnotherUp(Port):
    """Normals are of a world with y up: their y and z are exchanged."""

    def normal(self, codes: Vector) -> Vector:
        x, y, z = super().normal(codes)
        return [x, z, y]


@DECODING.add("normals-in-view-space")
class _NormalsInViewSpace(Port):
    """Normals are turned into view space, the light is not."""

    def normal(self, codes: Vector) -> Vector:
        normal = super().normal(codes)
        return [self.do.dot(list(row), normal) for row in self.do.matrix(self.scene.camera.view_from_world[:3, :3])]


@DECODING.add("vertex-colors-in-bytes", small=True)
class _VertexColorsInBytes(Port):
    """Colours leave the vertex stage as bytes."""

    def clamped(self, channel: Floats) -> Floats:
        return np.rint(255.0 * super().clamped(channel)) / 255.0
