"""Bugs in stage 5."""
# An override does what its parent says, but for the fault in the class's docstring.
# ruff: noqa: D102

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.ports.splatting.atlas import Integers
from ibr_ref.oracle.ports.splatting.mutants.seeded import mutant
from ibr_ref.oracle.ports.splatting.resolve import Resolve


class ClearedToBlack(Resolve):
    """The background is black."""

    def background(self) -> Floats:
        return np.zeros(3)


class ColorsBlueFirst(Resolve):
    """The picture is written as BGR."""

    def written(self, color: Floats) -> Floats:
        return color[:, :, ::-1]


class FlippedRows(Resolve):
    """The picture is written from below, the depth is not."""

    def written(self, color: Floats) -> Floats:
        return color[::-1]


class EncodedForScreens(Resolve):
    """The picture goes through the sRGB curve."""

    def written(self, color: Floats) -> Floats:
        curve: Floats = np.where(color <= 0.0031308, 12.92 * color, 1.055 * color ** (1.0 / 2.4) - 0.055)
        return curve


class TruncatedPicture(Resolve):
    """Colours are written in bytes and rounded down."""

    def written(self, color: Floats) -> Floats:
        return np.floor(255.0 * color) / 255.0


class BlendedLeftOn(Resolve):
    """A share of 1/512 of the background shines through: blending is left on."""

    def splat_color(self, colors: Floats, winner: Integers) -> Floats:
        return super().splat_color(colors, winner) * (511.0 / 512.0) + self.background() / 512.0


class FirstSplatForNone(Resolve):
    """Splat 0 is taken for none: > for >=."""

    def shown(self, winner: Integers) -> Bools:
        return winner > 0


class LastSplatUnread(Resolve):
    """Colours are clamped to all but the last point: count − 1 taken twice."""

    def splat_color(self, colors: Floats, winner: Integers) -> Floats:
        return np.asarray(colors[np.minimum(winner, max(len(colors) - 2, 0))])


class ColorOfThePixelAbove(Resolve):
    """Winners are fetched one row too high: half a texel in the fetch."""

    def splat_color(self, colors: Floats, winner: Integers) -> Floats:
        return super().splat_color(colors, np.concatenate([winner[:1], winner[:-1]]))


class BackgroundOver256(Resolve):
    """The background's bytes are divided by 256, not by 255."""

    def background(self) -> Floats:
        return super().background() * (255.0 / 256.0)


class LastColumnUnresolved(Resolve):
    """The pass over the picture ends one column early."""

    def shown(self, winner: Integers) -> Bools:
        shown = super().shown(winner)
        shown[:, -1] = False
        return shown


MUTANTS = (
    mutant(ClearedToBlack),
    mutant(ColorsBlueFirst),
    mutant(FlippedRows),
    mutant(EncodedForScreens),
    mutant(TruncatedPicture, small=True),
    mutant(BlendedLeftOn, small=True),
    mutant(FirstSplatForNone, small=True),
    mutant(LastSplatUnread, small=True),
    mutant(ColorOfThePixelAbove),
    mutant(BackgroundOver256, small=True),
    mutant(LastColumnUnresolved, small=True),
)
