"""The final picture, judged from the case alone: whether a part of a fragment's box shows what the port has.

The whole box first, then parts of it: a part whose results exclude the port's colour or depth is dropped, what they leave of
it is kept, and split where the results are no planes over it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.colors import as_numbers
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.programs.displacement import Port as Program
from ibr_ref.oracle.referees.displacement.model import AXES
from ibr_ref.oracle.referees.displacement.picture import Boxes, Looks, Picture, joined_boxes, picture_of

BYTE = 1.0 / 255.0
"""The quantization of a picture: what differs by no more does not show (conventions.md, "Numbers")."""
FLAT = 2.0**-9
"""Colours that are off by no more than this from a plane over the box need no smaller one: half a byte."""
DEEP = 256.0 * UNIT
"""The same of depths."""
PROGRESS = 0.75
"""Where a part is off by more than so much of what the box was, its roundings are what is left: it need not be smaller."""
VAGUE = 32.0
"""Times `FLAT`: a result that wide says nothing, and its pixel counts as undecided."""
LEAST = 2.0**-6
"""Nor does a box that is smaller than this part of the whole one."""
LIKELY = 0.25
"""Of a box's half: around the place that the planes say, where most pixels of a right port are accepted at once."""
LEVEL = 1e-12
"""Slopes below it exclude nothing of a box: what a colour is off by, divided by them, is beyond any box."""
MARGIN = 1e-6
"""Of a box's half: what planes leave of it is cut in float64, and off by less."""
MOST_BOXES = 200
"""Boxes of a pixel; beyond, it is accepted, and counts as undecided."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Shown:
    """What a port's pixels show, a row a pixel."""

    color: Floats
    slack: float
    depth: Floats | None
    background: Bools
    """Whether it may be the background."""

    @classmethod
    def of(cls, picture: Picture, handed: Handed) -> Shown:
        """From what was handed in."""
        pixels, device = picture.pixels, picture.model.device
        found = picture.model.program.rows(np.asarray(handed["color"]))
        bytes_ = found.dtype == np.uint8
        color = as_numbers(found).reshape(pixels, 3)
        slack = (device.byte + 255.0 * UNIT) / 255.0 if bytes_ else 0.0
        behind = picture.model.background
        bare = np.all([np.abs(color[:, k] - x.value) <= slack + x.deviation for k, x in enumerate(behind)], axis=0)
        depth = None
        if "depth" in handed:
            depth = np.asarray(handed["depth"], np.float64).reshape(pixels)
            bare &= depth == 1.0
        return cls(color=color, slack=slack, depth=depth, background=bare)


@dataclass(eq=False)
class Search:
    """The state of a judgement, pixel by pixel."""

    picture: Picture
    shown: Shown
    accepted: Bools
    undecided: Bools
    deep: Bools = field(init=False)
    """Some outcome has the depth, whatever its colour: where none is accepted, colour is to blame."""

    def __post_init__(self) -> None:
        depth = self.shown.depth
        self.deep = np.ones_like(self.accepted) if depth is None else self.picture.winners.empty & (depth == 1.0)

    def run(self, among: Bools | None = None) -> None:
        """Box by box, for the pixels `among`."""
        picture = self.picture
        looks, lost = picture.all, picture.lost
        boxes = picture.whole(np.arange(len(picture.fragments)))
        open_ = ~self.accepted if among is None else ~self.accepted & among
        used = np.zeros(picture.pixels, np.int64)
        rows = np.flatnonzero(open_[looks.pixel])
        boxes, likely = self._tried(boxes, looks.take(rows), lost)
        for found, many in picture.looks(likely):
            self._tried(likely, found, many)  # what is left of them is a part of what is left of all
        while len(boxes):
            pixel = picture.fragments.pixel[boxes.fragment]
            keep = open_[pixel] & ~self.accepted[pixel]
            boxes, pixel = boxes.take(keep), pixel[keep]
            used += np.bincount(pixel, minlength=picture.pixels)
            full = used[pixel] > MOST_BOXES
            self.accepted[pixel[full]] = self.undecided[pixel[full]] = True
            boxes = boxes.take(~full)
            left = [self._tried(boxes, found, many)[0] for found, many in picture.looks(boxes)]
            boxes = joined_boxes(left) if left else boxes.take(slice(0, 0))

    def _tried(self, boxes: Boxes, looks: Looks, lost: Ints) -> tuple[Boxes, Boxes]:
        """Accept what is final, and hand back what is left of the boxes, and where in them the port's pixels seem to lie."""
        looks = looks.take(self.picture.shown(looks))
        good, off, low, high = self._compared(looks)
        least = boxes.half[looks.box].max(axis=1, initial=0.0) <= LEAST
        final = (off <= 1.0) | (off > PROGRESS * boxes.off[looks.box]) | least
        self.accepted[looks.pixel[good & final]] = True
        vague = looks.pixel[good & final & (off > VAGUE)]
        self.undecided[vague] = True
        tiny = boxes.half[lost].max(axis=1, initial=0.0) <= LEAST
        given_up = self.picture.fragments.pixel[boxes.fragment[lost[tiny]]]
        self.accepted[given_up] = self.undecided[given_up] = True
        go = good & ~final & ~self.accepted[looks.pixel]
        again = boxes.take(lost[~tiny]).parts()
        left = joined_boxes([again, _cut(boxes, looks.box[go], low[go], high[go], off[go])])
        here = boxes.take(looks.box[go])
        likely = replace(here, middle=here.middle + 0.5 * (low[go] + high[go]) * here.half, half=LIKELY * here.half)
        return left, replace(likely, off=off[go])

    def _compared(self, looks: Looks) -> tuple[Bools, Floats, Floats, Floats]:
        """Whether outcomes may be the port's, how far they are from planes, and what of the box is left, in [-1, 1]."""
        shown, pixel = self.shown, looks.pixel
        tests = [(x, shown.color[pixel, k], shown.slack, FLAT) for k, x in enumerate(looks.color)]
        if shown.depth is not None:
            tests.append((looks.depth, shown.depth[pixel], 0.0, DEEP))
        low, high = np.full((len(pixel), 2), -1.0), np.full((len(pixel), 2), 1.0)
        good, away = np.ones(len(pixel), np.bool_), np.zeros(len(pixel))
        with np.errstate(all="ignore"):
            for x, found, slack, step in tests:
                # Said the other way round: a result that is no number, between no ends, may be any.
                near = np.isfinite(found) & ~(np.abs(found - x.value) > x.deviation + slack)
                good &= near
                away = np.fmax(away, x.error / step)
            if shown.depth is not None:
                self.deep[pixel[near]] = True
            for _ in range(4):
                for x, found, slack, _ in tests:
                    _narrow(x, found, slack, low, high)
        good &= (low <= high + 1e-9).all(axis=1)
        return good, away, np.minimum(low, high), np.maximum(low, high)


def _narrow(x: Number, found: Floats, slack: float, low: Floats, high: Floats) -> None:
    """Cut off of a box what the plane of a number excludes."""
    zero = np.zeros(len(found))
    slopes = [x.slopes.get(name, zero) for name in AXES]
    left, off = found - x.value, x.error + slack
    for k in (0, 1):
        mine, other = slopes[k], slopes[1 - k]
        ends = np.stack([other * low[:, 1 - k], other * high[:, 1 - k]])
        bounds = np.stack([left - off - ends.max(axis=0), left + off - ends.min(axis=0)]) / mine
        usable = np.abs(mine) > LEVEL
        low[:, k] = np.where(usable, np.maximum(low[:, k], bounds.min(axis=0)), low[:, k])
        high[:, k] = np.where(usable, np.minimum(high[:, k], bounds.max(axis=0)), high[:, k])


def _cut(boxes: Boxes, box: Ints, low: Floats, high: Floats, off: Floats) -> Boxes:
    """What is left of boxes: the hull of what their outcomes leave, halved where that is most of it."""
    names, at = np.unique(box, return_inverse=True)
    least, most = np.full((len(names), 2), 1.0), np.full((len(names), 2), -1.0)
    np.minimum.at(least, at, low)
    np.maximum.at(most, at, high)
    here, worst = boxes.take(names), np.zeros(len(names))
    np.maximum.at(worst, at, off)
    left = Boxes(
        off=worst,
        fragment=here.fragment,
        middle=here.middle + 0.5 * (least + most) * here.half,
        half=0.5 * (most - least) * here.half + MARGIN,
    )
    large = ((most - least) > 1.0).any(axis=1)
    return joined_boxes([left.take(~large), left.take(large).parts()])


def judge_image(case: Case, device: Device, handed: Handed) -> Judgement:
    """Colour, and depth where it is handed in: one legal outcome must agree with both."""
    return judge_picture(picture_of(case, device), handed)


def judge_picture(picture: Picture, handed: Handed) -> Judgement:
    """The same by any program; of the pixels that the picture is of."""
    case, among = picture.model.case, picture.among
    search = searched(picture, Shown.of(picture, handed), among)
    if among is not None:
        search.accepted |= ~among
    names = ("depth", "color") if "depth" in handed else ("color",)
    blame = np.where(search.accepted, -1, np.where(search.deep, len(names) - 1, 0))
    shape, width = case.frame.depth.shape, hull_width(picture)
    return Judgement(
        stage="image",
        element="pixel",
        arrays=names,
        wrong=~search.accepted.reshape(shape),
        undecided=(undecided(case, picture, width) | search.undecided).reshape(shape),
        width=width.reshape(shape),
        blame=blame.astype(np.int8).reshape(shape),
    )


def explains(case: Case, device: Device, handed: Handed, among: Bools) -> bool:
    """Whether every pixel (H, W) `among` has a legal outcome that agrees."""
    few = among.reshape(-1)
    picture = picture_of(case, device, among=few)
    return bool(searched(picture, Shown.of(picture, handed), few).accepted[few].all())


def searched(picture: Picture, shown: Shown, among: Bools | None = None) -> Search:
    """All pixels, or those `among`."""
    search = Search(picture, shown, picture.winners.empty & shown.background, np.zeros(picture.pixels, np.bool_))
    search.run(among)
    return search


def undecided(case: Case, picture: Picture, width: Floats) -> Bools:
    """(pixels,) a legal outcome lies more than one lattice step from the reference's, or shows.

    What a bug makes is nowhere the reference's: of its program, whether one outcome shows beside another.
    """
    if picture.model.kind is not Program:
        return np.asarray((width > 2.0 * BYTE) | (picture.winners.empty & np.isfinite(width)))
    stages, pixels = case.frame.stages, picture.pixels
    looks = picture.all.take(picture.shown(picture.all))
    index, polygon = (stages[name].reshape(-1).astype(np.int64) for name in ("march.hit_index", "raster.patch_id"))
    reference = case.frame.color.reshape(-1, 3)[looks.pixel]
    behind = np.asarray(case.scene.background, np.float64)
    beyond = np.zeros(len(looks), np.bool_)
    for k, x in enumerate(looks.color):
        beyond |= np.maximum(x.low - reference[:, k], reference[:, k] - x.high) > BYTE
    same = (looks.polygon == polygon[looks.pixel]) & (index[looks.pixel] >= 0)
    far = same & (np.abs(looks.hit_index - index[looks.pixel]) > 1)
    result = np.zeros(pixels, np.bool_)
    result[looks.pixel[beyond | far]] = True
    result |= picture.winners.empty & (np.abs(case.frame.color.reshape(-1, 3) - behind).max(axis=1) > BYTE)
    return result


def hull_width(picture: Picture) -> Floats:
    """(pixels,) from the least to the largest colour of whole boxes, of the widest channel; NaN where nothing is shown."""
    looks = picture.all.take(picture.shown(picture.all))
    low, high = np.full((picture.pixels, 3), np.inf), np.full((picture.pixels, 3), -np.inf)
    for k, x in enumerate(looks.color):
        np.minimum.at(low[:, k], looks.pixel, x.low)
        np.maximum.at(high[:, k], looks.pixel, x.high)
    width = (high - low).max(axis=1)
    width[picture.fragments.pixel[picture.lost]] = 1.0
    return np.asarray(np.where(np.isfinite(width), np.clip(width, 0.0, 1.0), np.nan), np.float64)
