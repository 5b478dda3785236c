"""The final picture, from the case alone: all that a pixel may show."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement import Params, Scene
from ibr_ref.oracle.accept.bounded import Bounded, exact, uploaded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.accept.winners import Winners
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.displacement.arrays import joined
from ibr_ref.oracle.referees.displacement.constants import Constants, constants_of
from ibr_ref.oracle.referees.displacement.hits import Hits, hits_of
from ibr_ref.oracle.referees.displacement.raster import Fragments, fragments_of
from ibr_ref.oracle.referees.displacement.shown import lighted, shades_of, winners_of
from ibr_ref.oracle.referees.displacement.vertex import Faces, faces_of, triangles_of

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

BYTE = 1.0 / 255.0
"""The quantization of a picture: what differs by no more does not show (conventions.md, "Numbers")."""


@dataclass(frozen=True, eq=False)
class Candidates:
    """What a scene alone says of the stages and of the picture, each computed when it is asked for."""

    scene: Scene
    params: Params
    device: Device

    @cached_property
    def constants(self) -> list[Constants]:
        """Of each polygon."""
        return constants_of(self.scene, self.device)

    @cached_property
    def faces(self) -> list[Faces]:
        """Of each polygon."""
        return [faces_of(each, self.params) for each in self.constants]

    @cached_property
    def fragments(self) -> Fragments:
        """Of all faces."""
        camera = self.scene.camera
        return fragments_of([triangles_of(each) for each in self.faces], self.device, camera.width, camera.height)

    @cached_property
    def _hits(self) -> tuple[Hits, Ints]:
        return hits_of(self.constants, self.params, self.fragments)

    @property
    def hits(self) -> Hits:
        """Of all fragments."""
        return self._hits[0]

    @property
    def lost(self) -> Ints:
        """Pixels with more branches than are followed."""
        return self._hits[1]

    @cached_property
    def _winners(self) -> Winners:
        camera = self.scene.camera
        return winners_of(self.hits, len(self.constants), camera.width * camera.height)

    @property
    def possible(self) -> Bools:
        """(n,) whether the outcome may be what its pixel shows."""
        return self._winners.possible

    @property
    def empty(self) -> Bools:
        """(pixels,) whether a pixel may show nothing."""
        return self._winners.empty

    @cached_property
    def accepted(self) -> Accepted:
        """All pictures of pixels."""
        hits = self.hits.take(self.possible & self.hits.kept)
        shades = shades_of(self.constants, self.params, hits)
        index, color = lighted(self.constants, hits, shades)
        at = shades.hit[index]
        empty = np.flatnonzero(self.empty)
        behind = np.broadcast_to(np.asarray(self.scene.background, np.float64), (len(empty), 3))
        nothing = np.full(len(empty), -1)
        return Accepted(
            pixel=np.concatenate([hits.pixel[at], empty]),
            polygon=np.concatenate([hits.polygon[at], nothing]),
            hit_index=np.concatenate([hits.hit_index[at], nothing]),
            color=joined([color, uploaded(behind, self.device)]),
            depth=joined([hits.depth[at], exact(np.ones(len(empty)), self.device)]).widened(self.device.depth_step),
            lost=self.lost,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Accepted:
    """(n,) pictures of pixels; a port's pixel must agree with one of them."""

    pixel: Ints
    polygon: Ints
    """-1: the background."""
    hit_index: Ints
    color: Bounded
    """(n, 3)."""
    depth: Bounded
    lost: Ints
    """Pixels where anything is accepted."""


_CANDIDATES: WeakKeyDictionary[Case, Candidates] = WeakKeyDictionary()


def candidates_of(case: Case, device: Device) -> Candidates:
    """Computed once for a case and its last device, for as long as the case lives."""
    known = _CANDIDATES.get(case)
    if known is None or known.device != device:
        known = _CANDIDATES[case] = Candidates(case.scene, case.params, device)
    return known


def judge_image(case: Case, device: Device, handed: Handed) -> Judgement:
    """Colour, and depth where it is handed in: one legal outcome must agree with both."""
    accepted = candidates_of(case, device).accepted
    height, width = case.scene.camera.height, case.scene.camera.width
    pixels = height * width
    color = np.asarray(handed["color"]).reshape(pixels, 3)
    names = ("depth", "color") if "depth" in handed else ("color",)
    agrees = [np.asarray(allows_color(accepted.color, color[accepted.pixel]).all(axis=1))]
    if "depth" in handed:
        depth = np.asarray(handed["depth"], np.float64).reshape(pixels)
        agrees.insert(0, accepted.depth.allows(depth[accepted.pixel]))
    right, blame = judged(accepted.pixel, agrees, pixels)
    right[accepted.lost] = True
    blame[right] = -1
    shape = (height, width)
    return Judgement(
        stage="image",
        element="pixel",
        arrays=names,
        wrong=~right.reshape(shape),
        undecided=undecided(case, accepted).reshape(shape),
        width=hull_width(accepted, pixels).reshape(shape),
        blame=blame.reshape(shape),
    )


def judged(element: Ints, agrees: list[Bools], count: int) -> tuple[Bools, NDArray[np.int8]]:
    """Whether any outcome agrees with all arrays, and the first array that no outcome agrees with.

    Where each array agrees with some outcome, but none with all, the first one that breaks the agreement is blamed.
    """
    blame = np.full(count, -1, np.int8)
    together = np.ones(len(element), np.bool_)
    right = np.ones(count, np.bool_)
    for name, each in enumerate(agrees):
        together = together & each
        right = np.zeros(count, np.bool_)
        right[element[together]] = True
        blame[~right & (blame < 0)] = name
    return right, blame


def undecided(case: Case, accepted: Accepted) -> Bools:
    """(pixels,) a legal outcome lies more than one lattice step from the reference's, or shows."""
    stages = case.frame.stages
    pixels = case.frame.depth.size
    index, polygon = (stages[name].reshape(-1).astype(np.int64) for name in ("march.hit_index", "raster.patch_id"))
    reference = case.frame.color.reshape(-1, 3)[accepted.pixel]
    beyond = np.maximum(accepted.color.low - reference, reference - accepted.color.high).max(axis=1) > BYTE
    same = (accepted.polygon == polygon[accepted.pixel]) & (index[accepted.pixel] >= 0) & (accepted.hit_index >= 0)
    far = same & (np.abs(accepted.hit_index - index[accepted.pixel]) > 1)
    result = np.zeros(pixels, np.bool_)
    result[accepted.pixel[beyond | far]] = True
    result[accepted.lost] = True
    return result


def hull_width(accepted: Accepted, pixels: int) -> NDArray[np.float64]:
    """(pixels,) from the least to the largest accepted colour, of the widest channel."""
    low, high = np.full((pixels, 3), np.inf), np.full((pixels, 3), -np.inf)
    np.minimum.at(low, accepted.pixel, accepted.color.low)
    np.maximum.at(high, accepted.pixel, accepted.color.high)
    width = (high - low).max(axis=1)
    width[accepted.lost] = 1.0
    return np.where(np.isfinite(width), np.maximum(width, 0.0), np.nan)
