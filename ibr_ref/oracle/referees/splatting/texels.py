"""Stages normals and atlas: where the images lie on the pages, and what is there, texel by texel."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.arithmetic.decisions import joined
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.splatting.model import Model
from ibr_ref.oracle.referees.splatting.points import Port
from ibr_ref.oracle.referees.splatting.verdict import judgement

CHUNK = 1 << 13
"""Pixels that are followed at a time: their arrays stay in the cache."""


# --- Normals ---------------------------------------------------------------------------------------------------------


def judge_normals(port: Port, among: Bools | None = None) -> Judgement:
    """All texels of all images, in order, as one row of elements, or those `among`."""
    model, handed, parts, first = port.model, port.handed, [], 0
    for number, image in enumerate(model.case.scene.images):
        size = np.size(image.arrays[1])
        parts.append(_normals(model, handed, number, None if among is None else among[first : first + size]))
        first += size
    wrong, undecided, width, places = (np.concatenate([part[k] for part in parts]) for k in range(4))
    return judgement("normals", "texel", {"atlas.normal": wrong}, undecided, width, places=places)


def _normals(model: Model, handed: Handed, number: int, among: Bools | None) -> tuple[NDArray[Any], ...]:
    """Of one image, flat."""
    mask = model.case.scene.images[number].arrays[2]
    pixel, codes, lost = codes_of(model, number, among)
    found, rect, hidden = read(model, handed, number, pixel, codes)
    wrong = ~_agree(found, pixel, codes)
    off = ~mask.reshape(-1)
    wrong[off] = (found[off] != model.preparation.unused()).any(axis=1)
    wrong[hidden] = False
    undecided, width = _spread(len(wrong), pixel, codes)
    wrong[lost], undecided[lost] = False, True
    if among is not None:
        wrong &= among
    rows, columns = (index.reshape(-1) for index in np.indices(mask.shape))
    places = np.stack([np.full_like(rows, rect[0]), rows + rect[2], columns + rect[1]], axis=1)
    return wrong, undecided, width, places


def codes_of(model: Model, number: int, among: Bools | None = None) -> tuple[Ints, list[Number], Ints]:
    """The legal codes of an image's points: pixel and codes of each outcome; and the pixels that have too many."""
    machine, preparation = model.machine, model.preparation
    with np.errstate(all="ignore"):
        surface = preparation.surface(model.case.scene.images[number])
    asked = np.flatnonzero(surface.mask.reshape(-1) if among is None else surface.mask.reshape(-1) & among)
    pixels, codes, lost = [np.zeros(0, np.int64)], [[Number(machine, np.zeros(0))] * 3], [np.zeros(0, np.int64)]

    def followed(some: Ints) -> tuple[Ints, dict[str, Any], Ints]:
        def run(origin: Ints) -> dict[str, Any]:
            return {"codes": [machine.of(x) for x in preparation.codes_at(surface, some[origin])]}

        with np.errstate(all="ignore"):
            return some, *machine.follow(run, len(some))

    jobs = [partial(followed, asked[first : first + CHUNK]) for first in range(0, len(asked), CHUNK)]
    for some, found, many in machine.side_by_side(jobs):
        pixels.append(some[found["origin"]])
        codes.append(found["codes"])
        lost.append(some[many])
    return np.concatenate(pixels), joined(codes), np.concatenate(lost)


def _agree(found: Floats, pixel: Ints, codes: list[Number]) -> Bools:
    """Which pixels have the codes of an outcome."""
    at = found[pixel]
    fits = np.all([(x.low <= at[:, k]) & (at[:, k] <= x.high) for k, x in enumerate(codes)], axis=0)
    result = np.zeros(len(found), np.bool_)
    result[pixel[fits]] = True
    return result


def _spread(count: int, pixel: Ints, codes: list[Number]) -> tuple[Bools, Floats]:
    """Of each pixel: whether two outcomes differ by more than one code, and the width of its widest one."""
    least, most, width = np.full((count, 3), np.inf), np.full((count, 3), -np.inf), np.full(count, np.nan)
    for k, x in enumerate(codes):
        np.minimum.at(least[:, k], pixel, x.low)
        np.maximum.at(most[:, k], pixel, x.high)
        np.fmax.at(width, pixel, x.high - x.low)
    return np.asarray((most - least).max(axis=1) > 1.0), width


def read(model: Model, handed: Handed, number: int, pixel: Ints, codes: list[Number]) -> tuple[Floats, Ints, Bools]:
    """(n, 3) an image's codes, the rectangle that they are read from, and the texels that others lie over.

    The rectangle is the port's if more of them are right there: where it put the image is another stage's matter.
    """
    rects = np.asarray(model.case.frame.stages["atlas.rects"], np.int64)
    own = [np.asarray(handed["atlas.rects"], np.int64)] if "atlas.rects" in handed else []
    mask = model.case.scene.images[number].arrays[2]
    best, found = -1, (np.full((mask.size, 3), np.nan), rects[number], np.zeros(mask.size, np.bool_))
    for places in [rects, *own]:
        texels = cut_out(handed["atlas.normal"], places[number])
        if texels is not None and texels.shape == (*mask.shape, 3):
            flat, hidden = texels.reshape(-1, 3).astype(np.float64), _overwritten(places, number).reshape(-1)
            right = int((_agree(flat, pixel, codes) | hidden).sum())
            if right > best:
                best, found = right, (flat, places[number], hidden)
    return found


def _overwritten(rects: Ints, image: int) -> Bools:
    """(H, W) texels of an image that lie in another one's rectangle too: whose normal is there, nobody can tell."""
    page, x, y, width, height = rects[image].tolist()
    result = np.zeros((height, width), np.bool_)
    for other in np.flatnonzero((rects[:, 0] == page) & (np.arange(len(rects)) != image)):
        _, left, top, across, down = rects[other].tolist()
        rows = slice(max(top - y, 0), max(top + down - y, 0))
        result[rows, max(left - x, 0) : max(left + across - x, 0)] = True
    return result


def cut_out(pages: Any, rect: Ints) -> NDArray[Any] | None:
    """An image's texels from the pages of an atlas; None where the rectangle does not lie on one."""
    page, x, y, width, height = (int(number) for number in rect)
    if not 0 <= page < len(pages) or min(x, y) < 0:
        return None
    rows, columns = np.shape(pages[page])[:2]
    if y + height > rows or x + width > columns:
        return None
    return np.asarray(pages[page])[y : y + height, x : x + width]


# --- Atlas -----------------------------------------------------------------------------------------------------------

ARRAYS = ("atlas.rects", "atlas.color", "atlas.depth", "atlas.normal")


def judge_atlas(port: Port) -> Judgement:
    """All texels of all pages of the reference's, as one row of elements; a wrong rectangle is one of all its texels.

    Normals are judged by their own stage; here only that there are none beside the images.
    """
    model, stages = port.model, port.model.case.frame.stages
    given = {name: port.handed[name] for name in ARRAYS if name in port.handed}
    shapes = [page.shape[:2] for page in stages["atlas.depth"]]
    owners = _owners(stages["atlas.rects"], shapes)
    owner = np.concatenate([each.reshape(-1) for each in owners])
    bad: dict[str, Bools] = {}
    width = np.full(len(owner), np.nan)
    if "atlas.rects" in given:
        differs = (np.asarray(given["atlas.rects"]) != model.atlas["atlas.rects"]).any(axis=1)
        bad["atlas.rects"] = np.r_[differs, False][owner]
    for name in ("atlas.color", "atlas.depth"):
        if name in given:
            legal = [page_of(model.atlas[name], i, shape) for i, shape in enumerate(shapes)]
            found = [page_of(given[name], i, shape) for i, shape in enumerate(shapes)]
            texels = joined([x.each(_rows, None) for x in legal])
            bad[name] = ~texels.allows(np.concatenate([_flat(x) for x in found])).all(axis=1)
            width = np.fmax(width, 2.0 * texels.deviation.max(axis=1))
    if "atlas.normal" in given:
        codes, there = (
            np.concatenate([_flat(page_of(pages, i, shape)) for i, shape in enumerate(shapes)])
            for pages in (given["atlas.normal"], model.atlas["atlas.depth"])
        )
        same = (codes == 0) | (np.isnan(codes) & np.isnan(there))
        free = np.concatenate([each.reshape(-1) for each in _owners(model.atlas["atlas.rects"], shapes)]) < 0
        bad["atlas.normal"] = free & ~same.all(axis=1)
    return judgement("atlas", "texel", bad, np.zeros(len(width), np.bool_), width, places=_places(owners))


def _rows(page: Floats) -> Floats:
    """(h w, c) of (h, w) or (h, w, c)."""
    return page.reshape(page.shape[0] * page.shape[1], -1)


def _flat(page: Number) -> Floats:
    return _rows(page.value)


def _places(pages: list[Ints]) -> Ints:
    """(texels, 3) page, row and column."""
    return np.concatenate(
        [np.insert(np.indices(page.shape).reshape(2, -1).T, 0, number, axis=1) for number, page in enumerate(pages)]
    )


def _owners(rects: Ints, shapes: list[tuple[int, int]]) -> list[Ints]:
    """The image that each texel of each page belongs to; -1 none."""
    owners = [np.full(shape, -1, np.int64) for shape in shapes]
    for image, (page, x, y, width, height) in enumerate(rects.tolist()):
        if page < len(owners):
            owners[page][y : y + height, x : x + width] = image
    return owners


def page_of(pages: Any, index: int, shape: tuple[int, ...]) -> Number:
    """A page of another size, with NaN for texels that it has not."""
    found = pages[min(index, len(pages) - 1)]
    number = found if isinstance(found, Number) else Number(None, np.asarray(found, np.float64))
    shape = (*shape, *number.shape[2:])
    rows, columns = (min(a, b) for a, b in zip(number.shape[:2], shape[:2], strict=True))
    rows = rows if index < len(pages) else 0
    value, error = np.full(shape, np.nan), np.zeros(shape)
    value[:rows, :columns] = number.value[:rows, :columns]
    error[:rows, :columns] = number.deviation[:rows, :columns]
    return Number(number.do, value, error)
