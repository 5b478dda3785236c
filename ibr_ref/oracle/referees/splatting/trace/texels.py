"""One texel: the choice of neighbours and the normal's code; or what the atlas has there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.referees.rows import compared, compared_numbers, number, text, told
from ibr_ref.oracle.referees.splatting.atlas import page_of, texels
from ibr_ref.oracle.referees.splatting.normals import JUMP, Codes, read, steps, surface
from ibr_ref.oracle.referees.splatting.table import cut_out

SIDES = {1: {1: "right", -1: "left", 0: "none"}, 0: {1: "below", -1: "above", 0: "none"}}


def normal_texel(case: Case, device: Device, handed: Handed, texel: int) -> list[TraceRow]:
    """The neighbours, the outcomes, and the codes."""
    sizes = [int(np.prod(np.shape(image.mask))) for image in case.scene.images]
    ends = np.cumsum(sizes)
    image = int(np.searchsorted(ends, texel, side="right"))
    shape = np.shape(case.scene.images[image].mask)
    row, column = (int(i) for i in np.unravel_index(texel - (ends[image] - sizes[image]), shape))
    described = surface(case.scene.images[image], device)
    rows = [told("image, row, column", (image, row, column)), told("on the mask", bool(described.valid[row, column]))]
    legal = Codes(described)
    if described.valid[row, column]:
        rows.append(number("depth", [described.depth[row, column]]))
        rows += _neighbours(described.depth, described.valid, row, column)
        for axis, name in ((1, "neighbour on the row"), (0, "neighbour in the column")):
            found = steps(described, axis)
            allowed = [SIDES[axis][side] for side, where in found.legal.items() if where[row, column]]
            rows.append(told(name, SIDES[axis][int(found.reference[row, column])]))
            rows.append(told(f"{name}: legal", " or ".join(allowed)))
        for pixels, low, high in legal.outcomes:
            for i in np.flatnonzero((pixels == (row, column)).all(axis=1)):
                rows.append(told("codes of one outcome, from and to", f"{text(low[i])} to {text(high[i])}"))
    mine = cut_out(case.frame.stages["atlas.normal"], case.frame.stages["atlas.rects"][image])
    wrong, place = read(case, handed, image, legal)
    theirs, index = cut_out(handed["atlas.normal"], place), (int(place[0]), row + int(place[2]), column + int(place[1]))
    if mine is None or theirs is None or theirs.shape != mine.shape:
        return rows
    code, port = (array[row, column].astype(np.float64) for array in (mine, theirs))
    return [*rows, compared_numbers("code", code, port, not wrong[row, column], "atlas.normal", index)]


def _neighbours(depth: Bounded, valid: np.ndarray, row: int, column: int) -> list[TraceRow]:
    rows = []
    for axis, side in ((1, 1), (1, -1), (0, 1), (0, -1)):
        other = (row + side * (axis == 0), column + side * (axis == 1))
        name = SIDES[axis][side]
        inside = 0 <= other[0] < valid.shape[0] and 0 <= other[1] < valid.shape[1]
        if not inside or not valid[other]:
            rows.append(told(f"{name}: on the image and its mask", "no"))
            continue
        step = abs(depth.value[other] - depth.value[row, column])
        margin = JUMP * depth.value[row, column] - step
        bound = float(depth.error[other] + depth.error[row, column])
        rows.append(compared(f"{name}: {step:.9g} <= 0.05 z", bool(margin >= 0.0), float(margin), bound))
    return rows


def atlas_texel(case: Case, device: Device, handed: Handed, texel: int) -> list[TraceRow]:
    """Where it lies, whose it is, and its three maps."""
    stages = case.frame.stages
    sizes = [int(np.prod(page.shape[:2])) for page in stages["atlas.depth"]]
    ends = np.cumsum(sizes)
    page = int(np.searchsorted(ends, texel, side="right"))
    row, column = (
        int(i) for i in np.unravel_index(texel - (ends[page] - sizes[page]), stages["atlas.depth"][page].shape)
    )
    rows = [told("page, row, column", (page, row, column))]
    for image, rect in enumerate(stages["atlas.rects"].tolist()):
        if rect[0] == page and rect[1] <= column < rect[1] + rect[3] and rect[2] <= row < rect[2] + rect[4]:
            rows.append(_rectangle(case, handed, image))
    for name, bounds in texels(case, device).items():
        bound = bounds[page][row, column]
        parts = [bound[c] for c in range(3)] if name == "atlas.color" else [bound]
        port = page_of(handed[name], page, bounds[page].value.shape)[row, column] if name in handed else None
        rows.append(number(name, parts, port, array=name, index=(page, row, column)))
    if "atlas.normal" in handed:
        mine = stages["atlas.normal"][page]
        theirs = page_of(handed["atlas.normal"], page, mine.shape)[row, column]
        beside = mine[row, column].any() or np.array_equal(mine[row, column], theirs)  # of an image: judged before
        code, place = mine[row, column].astype(np.float64), (page, row, column)
        rows.append(compared_numbers("atlas.normal", code, theirs, beside, "atlas.normal", place))
    return rows


def _rectangle(case: Case, handed: Handed, image: int) -> TraceRow:
    """Where an image lies."""
    mine, theirs = (
        None if array is None else ", ".join(map(str, np.asarray(array)[image].tolist()))
        for array in (case.frame.stages["atlas.rects"], handed.get("atlas.rects"))
    )
    row = told(f"image {image}: page, x, y, width, height", mine, theirs, array="atlas.rects", index=(image,))
    return replace(row, element="image")
