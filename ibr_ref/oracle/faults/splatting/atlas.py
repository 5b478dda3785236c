"""Bugs of the atlas stage."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.splatting.atlas import Pages, Texels
from ibr_ref.oracle.programs.splatting.case import Image, Ints
from ibr_ref.oracle.programs.splatting.port import Port

ATLAS = Bugs("atlas")


@ATLAS.add("blue-green-red")
class _BlueGreenRed(Port):
    """Texels are uploaded as BGR and fetched as RGB."""

    def color_texels(self, image: Image) -> Texels:
        return super().color_texels(image)[:, :, ::-1]


@ATLAS.add("upside-down")
class _UpsideDown(Port):
    """The colours' rows are uploaded from below, as a GL loader does that expects row 0 there."""

    def color_texels(self, image: Image) -> Texels:
        return super().color_texels(image)[::-1]


@ATLAS.add("truncated-bytes", small=True)
class _TruncatedBytes(Port):
    """Colours are stored in bytes, floor(255 c), not rounded."""

    def color_texels(self, image: Image) -> Texels:
        return np.floor(255.0 * super().color_texels(image)) / 255.0


@ATLAS.add("depths-of-half-precision", small=True)
class _DepthsOfHalfPrecision(Port):
    """Depths are stored as half floats."""

    def depth_texels(self, image: Image) -> Texels:
        return half(super().depth_texels(image))


@ATLAS.add("sixteen-bit-depths", small=True)
class _SixteenBitDepths(Port):
    """Depths are stored in 16 bits between the planes of the camera and rounded down."""

    def depth_texels(self, image: Image) -> Texels:
        depth, (near, far) = super().depth_texels(image), (image.camera.near, image.camera.far)
        steps = np.floor(65535.0 * (depth - near) / (far - near))
        return np.where(image.arrays[2], near + steps / 65535.0 * (far - near), 0.0)


@ATLAS.add("overlapping-shelves")
class _OverlappingShelves(Port):
    """A shelf is as high as its last image, not as its highest."""

    def shelf_height(self, shelf: int, height: int) -> int:
        return height


@ATLAS.add("tall-and-wide", hidden="the vertex stage does not read the rectangles' sizes")
class _TallAndWide(Port):
    """Rectangles are handed in with width and height exchanged."""

    def rects(self, places: Ints) -> Ints:
        return places[:, [0, 1, 2, 4, 3]]


@ATLAS.add("one-column-off")
class _OneColumnOff(Port):
    """Rectangles of all images but the first on their shelf begin one column too far left."""

    def rects(self, places: Ints) -> Ints:
        return places - np.where(places[:, 1:2] > 0, np.array([0, 1, 0, 0, 0], np.int32), np.int32(0))


@ATLAS.add("colors-off-the-mask", hidden="a texel off the mask is never fetched")
class _ColorsOffTheMask(Port):
    """Masked-off texels keep their colours."""

    def color_texels(self, image: Image) -> Texels:
        return self.do.widened(self.do.texels(image.arrays[0]), quotients=1)


@ATLAS.add("first-page-only")
class _FirstPageOnly(Port):
    """Every page holds the colours of the first that fit on it: the page is not bound again."""

    def color_pages(self, places: Ints, textures: Sequence[Texels]) -> Pages:
        first, *others = super().color_pages(places, textures)
        result = [first]
        for page in others:
            height, width = np.minimum(page.shape[:2], first.shape[:2])
            corner = slice(height), slice(width)
            result.append(self.do.replaced(page, corner, first[corner]))
        return tuple(result)


@ATLAS.add("bytes-over-256", small=True)
class _BytesOver256(Port):
    """Bytes of colour are divided by 256, not by 255."""

    def color_texels(self, image: Image) -> Texels:
        return self.do.multiply(255.0 / 256.0, super().color_texels(image))


@ATLAS.add(
    "colors-of-half-precision", small=True, hidden="far below the steps of bytes, and as often too bright as too dark"
)
class _ColorsOfHalfPrecision(Port):
    """Colours are stored as half floats."""

    def color_texels(self, image: Image) -> Texels:
        return half(super().color_texels(image))


@ATLAS.add("page-not-filled", hidden="texels are fetched from where they were put")
class _PageNotFilled(Port):
    """An image that just fits is put on the next shelf or page: < for <=."""

    def fits(self, start: int, extent: int) -> bool:
        return start == 0 or start + extent < self.params.max_atlas_size


@ATLAS.add("gutter-between-shelves", hidden="texels are fetched from where they were put")
class _GutterBetweenShelves(Port):
    """A row of texels is left free below every shelf."""

    def shelf_height(self, shelf: int, height: int) -> int:
        return max(shelf, height + 1)


@ATLAS.add("depths-upside-down")
class _DepthsUpsideDown(Port):
    """The depths' rows are uploaded from below, those of the colours from above."""

    def depth_texels(self, image: Image) -> Texels:
        return super().depth_texels(image)[::-1]


@ATLAS.add("texels-decoded-from-srgb")
class _TexelsDecodedFromSrgb(Port):
    """Colours are uploaded as sRGB and made linear, though they are linear already."""

    def color_texels(self, image: Image) -> Texels:
        return super().color_texels(image) ** 2.2


@ATLAS.add("depths-of-millimetres", small=True)
class _DepthsOfMillimetres(Port):
    """Depths are stored in whole thousandths of the world's unit, as depth cameras do."""

    def depth_texels(self, image: Image) -> Texels:
        return np.rint(1000.0 * super().depth_texels(image)) / 1000.0


@ATLAS.add("colors-of-ten-bits", small=True)
class _ColorsOfTenBits(Port):
    """Colours are stored as RGB10_A2."""

    def color_texels(self, image: Image) -> Texels:
        return np.rint(1023.0 * super().color_texels(image)) / 1023.0
