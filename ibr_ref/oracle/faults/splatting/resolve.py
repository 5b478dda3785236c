"""Bugs of resolve: the colour write."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.splatting.case import Bools, Floats, Ints
from ibr_ref.oracle.programs.splatting.port import Port

RESOLVE = Bugs("resolve")


@RESOLVE.add("cleared-to-black")
class _ClearedToBlack(Port):
    """The background is black."""

    def background(self) -> Floats:
        return np.zeros(3)


@RESOLVE.add("colors-blue-first")
class _ColorsBlueFirst(Port):
    """The picture is written as BGR."""

    def written(self, color: Floats) -> Floats:
        return color[..., ::-1]


@RESOLVE.add("flipped-rows")
class _FlippedRows(Port):
    """The picture is written from below, the depth is not."""

    def rows(self, picture: Any) -> Any:
        return picture[::-1]


@RESOLVE.add("encoded-for-screens")
class _EncodedForScreens(Port):
    """The picture goes through the sRGB curve."""

    def written(self, color: Floats) -> Floats:
        return np.where(color <= 0.0031308, 12.92 * color, 1.055 * color ** (1.0 / 2.4) - 0.055)


@RESOLVE.add("truncated-picture", small=True)
class _TruncatedPicture(Port):
    """Colours are written in bytes and rounded down."""

    def written(self, color: Floats) -> Floats:
        return np.floor(255.0 * color) / 255.0


@RESOLVE.add("blended-left-on", small=True)
class _BlendedLeftOn(Port):
    """A share of 1/512 of the background shines through: blending is left on."""

    def splat_color(self, colors: Floats, winner: Ints) -> Floats:
        return super().splat_color(colors, winner) * (511.0 / 512.0) + self.background() / 512.0


@RESOLVE.add("first-splat-for-none", small=True)
class _FirstSplatForNone(Port):
    """Splat 0 is taken for none: > for >=."""

    def shown(self, winner: Ints) -> Bools:
        return winner > 0


@RESOLVE.add("last-splat-unread", small=True)
class _LastSplatUnread(Port):
    """Colours are clamped to all but the last point: count − 1 taken twice."""

    def splat_color(self, colors: Floats, winner: Ints) -> Floats:
        return colors[np.minimum(winner, max(len(colors) - 2, 0))]


@RESOLVE.add("color-of-the-pixel-above")
class _ColorOfThePixelAbove(Port):
    """Winners are fetched one row too high: half a texel in the fetch."""

    def read_at(self, row: Ints, column: Ints) -> tuple[Ints, Ints]:
        return np.maximum(row - 1, 0), column


@RESOLVE.add("background-over-256", small=True)
class _BackgroundOver256(Port):
    """The background's bytes are divided by 256, not by 255."""

    def background(self) -> Floats:
        return super().background() * (255.0 / 256.0)


@RESOLVE.add("last-column-unresolved", small=True)
class _LastColumnUnresolved(Port):
    """The pass over the picture ends one column early."""

    def drawn(self, row: Ints, column: Ints) -> Bools:
        return column < self.scene.camera.width - 1


@RESOLVE.add("picture-mirrored")
class _PictureMirrored(Port):
    """The picture's columns run from the right."""

    def rows(self, picture: Any) -> Any:
        return picture[:, ::-1]


@RESOLVE.add("decoded-for-screens")
class _DecodedForScreens(Port):
    """The picture is made linear once more: a gamma of 2.2 for 1/2.2."""

    def written(self, color: Floats) -> Floats:
        return color**2.2


@RESOLVE.add("colors-in-256-steps", small=True)
class _ColorsIn256Steps(Port):
    """Bytes are floor(256 c), and read as k/256."""

    def written(self, color: Floats) -> Floats:
        return np.floor(256.0 * np.clip(color, 0.0, 1.0)) / 256.0


@RESOLVE.add("ten-bits-a-channel", small=True)
class _TenBitsAChannel(Port):
    """The frame buffer has ten bits a channel."""

    def written(self, color: Floats) -> Floats:
        return np.rint(1023.0 * color) / 1023.0


@RESOLVE.add("color-of-the-pixel-to-the-left")
class _ColorOfThePixelToTheLeft(Port):
    """Winners are fetched one column too far left: half a texel in the fetch."""

    def read_at(self, row: Ints, column: Ints) -> tuple[Ints, Ints]:
        return row, np.maximum(column - 1, 0)


@RESOLVE.add("picture-of-half-precision", small=True, hidden="far below the steps of bytes")
class _PictureOfHalfPrecision(Port):
    """The frame buffer holds half floats."""

    def written(self, color: Floats) -> Floats:
        return half(color)


@RESOLVE.add("bytes-rounded-up", small=True)
class _BytesRoundedUp(Port):
    """Colours are written in bytes and rounded up."""

    def written(self, color: Floats) -> Floats:
        return np.ceil(255.0 * color) / 255.0


@RESOLVE.add("first-row-unresolved", small=True)
class _FirstRowUnresolved(Port):
    """The pass over the picture begins with the second row."""

    def drawn(self, row: Ints, column: Ints) -> Bools:
        return row > 0
