"""The computation of one element, step by step: what the program tells of while it runs, beside what the port has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.referees.rows import compared_numbers, journaled, number, one, text, told
from ibr_ref.oracle.referees.splatting.model import NOTHING, Model
from ibr_ref.oracle.referees.splatting.points import Port
from ibr_ref.oracle.referees.splatting.texels import codes_of, cut_out, page_of, read
from ibr_ref.oracle.referees.splatting.trace_ellipses import Averaged
from ibr_ref.oracle.referees.splatting.trace_pixels import Pixel
from ibr_ref.oracle.referees.splatting.trace_points import journal, point_rows, shaped


def trace(model: Model, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
    """Rows of one element; index: (vertex,), (row, column) of a pixel, or (texel,) in the order of its judgement.

    Raises ValueError for a stage that the method has not.
    """
    if stage == "normals":
        return _normal(model, handed, index[0])
    if stage == "atlas":
        return _texel(model, handed, index[0])
    if stage == "vertex":
        return point_rows(shaped(Port(model, handed), index[0]), index[0])
    if stage in ("raster", "resolve", "image"):
        kind = Averaged if model.elliptic else Pixel
        return kind(Port(model, NOTHING if stage == "image" else handed), handed, (index[0], index[1])).rows()
    raise ValueError(f"stage: found {stage!r}, allowed: normals | atlas | vertex | raster | resolve | image")


def _normal(model: Model, handed: Handed, texel: int) -> list[TraceRow]:
    """The neighbours, the outcomes, and the codes."""
    images = model.case.scene.images
    ends = np.cumsum([0, *(np.size(image.arrays[1]) for image in images)])
    image = int(np.searchsorted(ends, texel, side="right")) - 1
    pixel, mask = texel - int(ends[image]), images[image].arrays[2]
    row, column = (int(i) for i in np.unravel_index(pixel, mask.shape))
    rows = [told("image, row, column", (image, row, column)), told("on the mask", bool(mask[row, column]))]
    among = np.arange(mask.size) == pixel
    pixels, codes, _ = codes_of(model, image, among)
    if mask[row, column]:
        surface = model.preparation.surface(images[image])
        rows.append(number("depth", one(surface.depth, pixel)))
        with journal(model) as kept:
            model.preparation.codes_at(surface, np.array([pixel]))
        rows += journaled(kept)
        for i in range(len(pixels)):
            ends_ = ([getattr(x, end)[i] for x in codes] for end in ("low", "high"))
            rows.append(told("codes of one outcome, from and to", " to ".join(text(each) for each in ends_)))
    mine = cut_out(model.case.frame.stages["atlas.normal"], model.case.frame.stages["atlas.rects"][image])
    every, all_codes, _ = codes_of(model, image)
    found, rect, hidden = read(model, handed, image, every, all_codes)
    if mine is None or np.isnan(found).all():
        return rows
    port = found[pixel]
    legal = bool(hidden[pixel]) or any(
        all(x.low[i] <= p <= x.high[i] for x, p in zip(codes, port, strict=True)) for i in range(len(pixels))
    )
    legal |= not mask[row, column] and not port.any()
    at = (int(rect[0]), row + int(rect[2]), column + int(rect[1]))
    return [*rows, compared_numbers("code", mine[row, column].astype(np.float64), port, legal, "atlas.normal", at)]


def _texel(model: Model, handed: Handed, texel: int) -> list[TraceRow]:
    """Where it lies, whose it is, and its three maps."""
    stages = model.case.frame.stages
    shapes = [page.shape[:2] for page in stages["atlas.depth"]]
    ends = np.cumsum([0, *(int(np.prod(shape)) for shape in shapes)])
    page = int(np.searchsorted(ends, texel, side="right")) - 1
    row, column = (int(i) for i in np.unravel_index(texel - int(ends[page]), shapes[page]))
    rows = [told("page, row, column", (page, row, column))]
    for image, rect in enumerate(stages["atlas.rects"].tolist()):
        if rect[0] == page and rect[1] <= column < rect[1] + rect[3] and rect[2] <= row < rect[2] + rect[4]:
            rows.append(_rectangle(model, handed, image))
    for name in ("atlas.color", "atlas.depth"):
        legal = model.atlas[name][page][row, column]
        parts = [one(x) for x in legal.each(np.atleast_1d, None)]
        port = page_of(handed[name], page, shapes[page]).value[row, column] if name in handed else None
        rows.append(number(name, parts, port, array=name, index=(page, row, column)))
    if "atlas.normal" in handed:
        mine = stages["atlas.normal"][page][row, column]
        theirs = page_of(handed["atlas.normal"], page, shapes[page]).value[row, column]
        beside = mine.any() or np.array_equal(mine, theirs)  # of an image: judged before
        place = (page, row, column)
        rows.append(compared_numbers("atlas.normal", mine.astype(float), theirs, beside, "atlas.normal", place))
    return rows


def _rectangle(model: Model, handed: Handed, image: int) -> TraceRow:
    """Where an image lies."""
    mine, theirs = (
        None if array is None else ", ".join(map(str, np.asarray(array)[image].tolist()))
        for array in (model.case.frame.stages["atlas.rects"], handed.get("atlas.rects"))
    )
    row = told(f"image {image}: page, x, y, width, height", mine, theirs, array="atlas.rects", index=(image,))
    return replace(row, element="image")
