"""Bugs in stage 2."""
# An override does what its parent says, but for the fault in the class's docstring.
# ruff: noqa: D102

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ibr_ref.oracle.ports.splatting.atlas import Atlas, Integers, Pages, Texels
from ibr_ref.oracle.ports.splatting.mutants.seeded import mutant


class BlueGreenRed(Atlas):
    """Texels are uploaded as BGR and fetched as RGB."""

    def color_texels(self, image: Any) -> Texels:
        return super().color_texels(image)[:, :, ::-1]


class UpsideDown(Atlas):
    """The colours' rows are uploaded from below, as a GL loader does that expects row 0 there."""

    def color_texels(self, image: Any) -> Texels:
        return super().color_texels(image)[::-1]


class TruncatedBytes(Atlas):
    """Colours are stored in bytes, floor(255 c), not rounded."""

    def color_texels(self, image: Any) -> Texels:
        return np.floor(255.0 * super().color_texels(image)) / 255.0


class DepthsOfHalfPrecision(Atlas):
    """Depths are stored as half floats."""

    def depth_texels(self, image: Any) -> Texels:
        return super().depth_texels(image).astype(np.float16).astype(np.float64)


class SixteenBitDepths(Atlas):
    """Depths are stored in 16 bits between the planes of the camera and rounded down."""

    def depth_texels(self, image: Any) -> Texels:
        depth, (near, far) = super().depth_texels(image), (image.camera.near, image.camera.far)
        steps = np.floor(65535.0 * (depth - near) / (far - near))
        return np.where(image.arrays[2], near + steps / 65535.0 * (far - near), 0.0)


class OverlappingShelves(Atlas):
    """A shelf is as high as its last image, not as its highest."""

    def shelf_height(self, shelf: int, height: int) -> int:
        return height


class TallAndWide(Atlas):
    """Rectangles are handed in with width and height exchanged."""

    def rects(self, places: Integers) -> Integers:
        return places[:, [0, 1, 2, 4, 3]]


class OneColumnOff(Atlas):
    """Rectangles of all images but the first on their shelf begin one column too far left."""

    def rects(self, places: Integers) -> Integers:
        return places - np.where(places[:, 1:2] > 0, np.array([0, 1, 0, 0, 0], np.int32), np.int32(0))


class ColorsOffTheMask(Atlas):
    """Masked-off texels keep their colours."""

    def color_texels(self, image: Any) -> Texels:
        return self.alu.number(image.arrays[0])


class FirstPageOnly(Atlas):
    """Every page holds the colours of the first that fit on it: the page is not bound again."""

    def pages(self, places: Integers, textures: Sequence[Texels]) -> Pages:
        pages = super().pages(places, textures)
        if textures[0].ndim < 3 or textures[0].dtype == np.uint8:
            return pages
        result = [page.copy() for page in pages]
        for page in result[1:]:
            height, width = np.minimum(page.shape[:2], pages[0].shape[:2])
            page[:height, :width] = pages[0][:height, :width]
        return tuple(result)


class BytesOver256(Atlas):
    """Bytes of colour are divided by 256, not by 255."""

    def color_texels(self, image: Any) -> Texels:
        return self.alu.multiply(255.0 / 256.0, super().color_texels(image))


class ColorsOfHalfPrecision(Atlas):
    """Colours are stored as half floats."""

    def color_texels(self, image: Any) -> Texels:
        return super().color_texels(image).astype(np.float16).astype(np.float64)


MUTANTS = (
    mutant(BlueGreenRed),
    mutant(UpsideDown),
    mutant(TruncatedBytes, small=True),
    mutant(DepthsOfHalfPrecision, small=True),
    mutant(SixteenBitDepths, small=True),
    mutant(OverlappingShelves),
    mutant(TallAndWide, hidden="the vertex stage does not read the rectangles' sizes"),
    mutant(OneColumnOff),
    mutant(ColorsOffTheMask, hidden="a texel off the mask is never fetched"),
    mutant(FirstPageOnly),
    mutant(BytesOver256, small=True),
    mutant(
        ColorsOfHalfPrecision, small=True, hidden="far below the steps of bytes, and as often too bright as too dark"
    ),
)
