"""Faults made by hand in what is handed in: found, in the stage where they are, and in no other."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from ibr_ref.oracle.device import PROFILES
from tests.oracle.judgements import complaints, first_wrong, picture
from tests.oracle.shadows.judged import REFEREE, Arrays, case, image, plain, reference, stages

SOFT, DIRECT = "shadows-soft", "shadows-direct"


def copied(arrays: Arrays) -> Arrays:
    return {name: array.copy() for name, array in arrays.items()}


def position(arrays: Arrays) -> None:
    arrays["maps.positions"][1, 2, 0] += 1e-5


def texel(arrays: Arrays) -> None:
    arrays["maps.image"][0, 1, 2, 3] = 0.5


def count(arrays: Arrays) -> None:
    arrays["maps.image"][0, 1, 2, 3] = 0.03


def control(arrays: Arrays) -> None:
    arrays["controls"][2, 1, 3, 2, 1] += 1e-6


def cell(arrays: Arrays) -> None:
    arrays["warp.cell"][4, 0] ^= 1


def fraction(arrays: Arrays) -> None:
    arrays["warp.fraction"][4, 1] += 1e-5


def row_grid(arrays: Arrays) -> None:
    arrays["warp.row_grids"][3, 1, 2, 2, 0] += 1e-5


def row(arrays: Arrays) -> None:
    arrays["warp.rows"][3, 0, 20, 20] += 1e-3


def grid(arrays: Arrays) -> None:
    arrays["warp.grid"][3, 2, 2, 0] += 1e-5


def warped(arrays: Arrays) -> None:
    arrays["warp.image"][8, 20, 20] += 1e-3


def depth(arrays: Arrays) -> None:
    arrays["depth"][60, 40] += 1e-3


def coord(arrays: Arrays) -> None:
    arrays["project.coord"][5, 60, 40, 1] += 1e-3


def shadow(arrays: Arrays) -> None:
    arrays["project.shadow"][5, 60, 40] += 1e-4


def total(arrays: Arrays) -> None:
    arrays["accumulate.shadow"][60, 40] += 1e-5


def shade(arrays: Arrays) -> None:
    arrays["color"][60, 40, 1] += 1e-4


FAULTS: list[tuple[Callable[[Arrays], None], str, str]] = [
    (position, "maps", "maps.positions"),
    (texel, "maps", "maps.image"),
    (count, "maps", "maps.image"),
    (control, "controls", "controls"),
    (cell, "warp", "warp.cell"),
    (fraction, "warp", "warp.fraction"),
    (row_grid, "warp", "warp.row_grids"),
    (row, "warp", "warp.rows"),
    (grid, "warp", "warp.grid"),
    (warped, "warp", "warp.image"),
    (depth, "depth", "depth"),
    (coord, "project", "project.coord"),
    (shadow, "project", "project.shadow"),
    (total, "accumulate", "accumulate.shadow"),
    (shade, "resolve", "color"),
]


def blocker(arrays: Arrays) -> None:
    arrays["project.blocker"][60, 57] += 1e-3


def breadth(arrays: Arrays) -> None:
    arrays["project.penumbra"][60, 57] += 1e-4


def percentage(arrays: Arrays) -> None:
    arrays["project.shadow"][60, 57] -= 0.02


SOFTENED = [(blocker, "project.blocker"), (breadth, "project.penumbra"), (percentage, "project.shadow")]


@pytest.mark.parametrize(("fault", "array"), SOFTENED, ids=[fault.__name__ for fault, _ in SOFTENED])
def test_a_fault_of_a_softened_map_is_found_where_it_is(fault: Callable[[Arrays], None], array: str) -> None:
    name = "shadows-penumbra"
    arrays = copied(plain(name))
    assert arrays["project.blocker"][60, 57] > 0.0
    fault(arrays)
    wrong = [j for j in stages(name, arrays, "ieee32") if j.wrong.any()]
    assert next(j.stage for j in wrong) == "project"
    assert wrong[0].wrong.sum() == 1
    assert wrong[0].arrays[wrong[0].blame[60, 57]] == array
    rows = REFEREE.trace(case(name), PROFILES["ieee32"], arrays, "project", (60, 57))
    assert array in {row.array for row in rows if row.note == "differs"}


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("fault", "stage", "array"), FAULTS, ids=[fault.__name__ for fault, _, _ in FAULTS])
def test_a_fault_is_found_where_it_is(fault: Callable[[Arrays], None], stage: str, array: str) -> None:
    arrays = copied(plain(SOFT))
    assert complaints(stages(SOFT, arrays, "ieee32")) == []
    fault(arrays)
    judged = stages(SOFT, arrays, "ieee32")
    assert first_wrong(judged) == stage
    found = next(j for j in judged if j.wrong.any())
    assert array in {found.arrays[i] for i in found.blame[found.wrong]}
    assert found.wrong.sum() == 1
    at = tuple(np.argwhere(found.wrong)[0].tolist())
    rows = REFEREE.trace(case(SOFT), PROFILES["ieee32"], arrays, stage, at)
    assert len(rows) >= 4
    assert any(row.note == "differs" for row in rows), rows


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "name",
    [SOFT, DIRECT, "shadows-filtered", "shadows-depths", "shadows-nearest", "shadows-many", "shadows-penumbra"],
)
def test_every_element_has_a_trace(name: str) -> None:
    arrays, device, random = plain(name), PROFILES["ieee32"], np.random.default_rng(3)
    for judged in [*stages(name, arrays, "ieee32"), image(name, picture(arrays), "ieee32")]:
        for place in random.integers(0, judged.wrong.size, 3):
            at = tuple(int(i) for i in np.unravel_index(place, judged.wrong.shape))
            rows = REFEREE.trace(case(name), device, arrays, judged.stage, at)
            assert rows
            assert all(isinstance(row.reference, str) and isinstance(row.port, str) for row in rows)
            assert judged.stage in ("image", "depth") or not any(row.note == "differs" for row in rows), (at, rows)


def test_a_stage_or_an_element_that_is_not_there_has_no_trace() -> None:
    with pytest.raises(ValueError, match="found 'shadow', allowed: maps"):
        REFEREE.trace(case(SOFT), PROFILES["ieee32"], plain(SOFT), "shadow", (0, 0))
    with pytest.raises(ValueError, match="index: found"):
        REFEREE.trace(case(SOFT), PROFILES["ieee32"], plain(SOFT), "controls", (9, 9, 9, 9))


@pytest.mark.parametrize(
    "name", ["color", "depth", "project.coord", "project.shadow", "accumulate.shadow", "warp.image", "warp.grid"]
)
def test_nan_is_wrong(name: str) -> None:
    arrays = copied(reference(SOFT))
    arrays[name][...] = np.nan
    judged = stages(SOFT, arrays, "ieee32")
    assert any(name in j.arrays and j.wrong.all() for j in judged)
    if name in ("color", "depth"):
        assert image(SOFT, {name: arrays[name]}).wrong.all()


@pytest.mark.parametrize("kept", [("color",), ("depth",), ("accumulate.shadow",), ("project.shadow", "color"),
                                  ("project.coord",), ("project.coord", "accumulate.shadow"), ("warp.image", "color"),
                                  ("warp.rows", "warp.image"), ("warp.grid",), ("warp.cell",), ("warp.fraction",),
                                  ("maps.image",), ("controls", "warp.row_grids"), ("depth", "project.shadow")])  # fmt: skip
def test_any_subset_can_be_handed_in(kept: tuple[str, ...]) -> None:
    for name in ("shadows-soft", "shadows-nearest", "shadows-coarse"):
        arrays = plain(name)
        handed = {array: arrays[array] for array in kept if array in arrays}
        judged = stages(name, handed, "ieee32")
        assert [array for j in judged for array in j.arrays] == [a for j in judged for a in j.arrays if a in handed]
        assert len({array for j in judged for array in j.arrays}) == len(handed)
        assert complaints(judged) == []


def test_other_kinds_of_numbers_are_the_same_numbers() -> None:
    arrays = plain(SOFT)
    changed = {k: v.astype(np.float32 if v.dtype.kind == "f" else np.int64) for k, v in arrays.items()}
    assert complaints(stages(SOFT, changed, "ieee32")) == []


def test_what_was_wrong_before_does_not_smear() -> None:
    """A port whose maps are all shifted by a texel is wrong in its maps alone, and one with wrong rows in these."""
    arrays = copied(plain("shadows-masks"))
    arrays["warp.image"] = np.roll(arrays["warp.image"], 3, axis=2)
    judged = {j.stage: j for j in stages("shadows-masks", arrays, "ieee32")}
    assert judged["warp"].wrong.any()
    assert [name for name, j in judged.items() if j.wrong.any()] == ["warp", "project"]
    assert judged["project"].arrays[judged["project"].blame[judged["project"].wrong][0]] == "project.shadow"
