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


class InverseDepthBytes(Atlas):
    """Depths go through the 8-bit codes of inverse depth that the files of real scenes hold."""

    def depth_texels(self, image: Any) -> Texels:
        near, far, mask = 1.0 / image.camera.near, 1.0 / image.camera.far, image.arrays[2]
        depth = np.where(mask, super().depth_texels(image), 1.0)
        steps = np.floor(255.0 * (1.0 / depth - far) / (near - far) + 0.5)
        return np.where(mask, 1.0 / (steps / 255.0 * (near - far) + far), 0.0)


class OverlappingShelves(Atlas):
    """A shelf is as high as its last image, not as its highest."""

    def shelf_height(self, shelf: int, height: int) -> int:
        return height


class FullShelves(Atlas):
    """An image that just fits goes to the next shelf, or page: < for <=."""

    def fits(self, start: int, extent: int) -> bool:
        return bool(start == 0 or start + extent < self.params.max_atlas_size)


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


MUTANTS = (
    mutant(BlueGreenRed),
    mutant(UpsideDown),
    mutant(TruncatedBytes, small=True),
    mutant(DepthsOfHalfPrecision),
    mutant(SixteenBitDepths, small=True),
    mutant(InverseDepthBytes),
    mutant(OverlappingShelves),
    mutant(FullShelves, hidden="the vertex stage reads where the rectangles say"),
    mutant(TallAndWide, hidden="the vertex stage does not read the rectangles' sizes"),
    mutant(OneColumnOff),
    mutant(ColorsOffTheMask, small=True, hidden="a texel off the mask is never fetched"),
    mutant(FirstPageOnly),
)
