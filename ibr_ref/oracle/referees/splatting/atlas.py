"""Stage atlas: where the images lie on the pages, and their texels, at the reference's places."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools
from ibr_ref.oracle.accept.bounded import Bounded, uploaded
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.splatting.table import stored_color
from ibr_ref.oracle.referees.splatting.verdict import judgement

ARRAYS = ("atlas.rects", "atlas.color", "atlas.depth", "atlas.normal")


def judge(case: Case, device: Device, handed: Handed) -> Judgement:
    """All texels of all pages of the reference's, as one row of elements; a wrong rectangle is one of all its texels.

    Normals are judged by their own stage; here only that there are none beside the images.
    """
    stages = case.frame.stages
    owners = _owners(stages["atlas.rects"], [page.shape[:2] for page in stages["atlas.depth"]])
    bad: dict[str, Bools] = {}
    width = np.full(sum(owner.size for owner in owners), np.nan)
    if "atlas.rects" in handed:
        differs = (np.asarray(handed["atlas.rects"]) != stages["atlas.rects"]).any(axis=1)
        bad["atlas.rects"] = _flat([np.r_[differs, False][owner] for owner in owners])
    for name, bounds in texels(case, device).items():
        if name in handed:
            pages = [page_of(handed[name], i, bound.value.shape) for i, bound in enumerate(bounds)]
            bad[name] = _flat([~_all(bound.allows(page)) for bound, page in zip(bounds, pages, strict=True)])
            width = np.fmax(width, 2.0 * _flat([_rows(bound.error) for bound in bounds]))
    if "atlas.normal" in handed:
        pages = [page_of(handed["atlas.normal"], i, page.shape) for i, page in enumerate(stages["atlas.normal"])]
        bad["atlas.normal"] = _flat([(owner < 0) & ~_all(page == 0) for owner, page in zip(owners, pages, strict=True)])
    return judgement("atlas", "texel", bad, np.zeros(len(width), np.bool_), width, places=_places(owners))


def _places(pages: list[NDArray[np.int64]]) -> NDArray[np.int64]:
    """(texels, 3) page, row and column."""
    return np.concatenate(
        [np.insert(np.indices(page.shape).reshape(2, -1).T, 0, number, axis=1) for number, page in enumerate(pages)]
    )


def texels(case: Case, device: Device) -> dict[str, list[Bounded]]:
    """Pages of colours and depths as a device stores them."""
    stages = case.frame.stages
    return {
        "atlas.color": [stored_color(page, device) for page in stages["atlas.color"]],
        "atlas.depth": [uploaded(page, device) for page in stages["atlas.depth"]],
    }


def _owners(rects: NDArray[np.int32], shapes: list[tuple[int, int]]) -> list[NDArray[np.int64]]:
    """The image that each texel of each page belongs to; -1 none."""
    owners = [np.full(shape, -1, np.int64) for shape in shapes]
    for image, (page, x, y, width, height) in enumerate(rects.tolist()):
        owners[page][y : y + height, x : x + width] = image
    return owners


def page_of(pages: Any, index: int, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """A page as the reference has it; texels that the port's has not are NaN."""
    result = np.full(shape, np.nan)
    if index < len(pages):
        found = np.asarray(pages[index], np.float64)
        rows, columns = (min(a, b) for a, b in zip(found.shape[:2], shape[:2], strict=True))
        result[:rows, :columns] = found[:rows, :columns]
    return result


def _all(allowed: Bools) -> Bools:
    return np.asarray(allowed.all(axis=2) if allowed.ndim == 3 else allowed, np.bool_)


def _rows(error: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(error.max(axis=2) if error.ndim == 3 else error)


def _flat(pages: list[Any]) -> NDArray[Any]:
    return np.concatenate([np.reshape(page, -1) for page in pages])
