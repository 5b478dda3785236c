"""The contracts, `<method>/contract.py`: what `render` makes is what they say, and so is what the pages say."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from ibr_ref import Light, displacement, methods, pages, shadows, splatting
from ibr_ref.contract import IMAGE, OWN, StageArray, described, spelled
from ibr_ref.io import Frame
from ibr_ref.oracle.schema.stages import contract_of
from tests.displacement import scenes as polygons
from tests.oracle.files import cases
from tests.shadows import scenes as stages

pytestmark = pytest.mark.usefixtures("one_thread")

Arrays = dict[str, NDArray[Any]]


def compared() -> tuple[str, Frame]:
    """A system that the paper compares with, which has a search of its own."""
    case = cases.displacement_maps()
    return "displacement", displacement.render(case.scene, displacement.Params(method="welsh"))


def discarded() -> tuple[str, Frame]:
    """The base alone, of a map with gaps at its border: rays that find nothing."""
    scene = displacement.Scene(
        polygons=[polygons.square(np.zeros((5, 6)))],
        camera=polygons.camera(width=24, height=18),
        light=Light(direction=(0, 0, 1)),
    )
    return "displacement", displacement.render(scene, displacement.Params(shadow_steps=2))


def ellipses() -> tuple[str, Frame]:
    case = cases.splatting_cameras()
    return "splatting", splatting.render(case.scene, splatting.Params(shape="ellipse"))


def dropped() -> tuple[str, Frame]:
    """A far plane through the points."""
    case = cases.splatting_cameras()
    camera = case.scene.camera
    eye, far = np.asarray(camera.eye)[:3], float(np.linalg.norm(np.asarray(camera.eye)[:3]))
    near_camera = type(camera).look_at(
        eye=eye, target=(0, 0, 0), near=0.1, far=far, width=camera.width, height=camera.height
    )
    return "splatting", splatting.render(replace(case.scene, camera=near_camera))


def grid() -> tuple[str, Frame]:
    return "shadows", shadows.render(stages.scene(), stages.params(map_size=16, method="grid", grid_size=3))


def of_case(make: Callable[[], Any]) -> Callable[[], tuple[str, Frame]]:
    return lambda: (make().method, make().frame)


FRAMES: dict[str, Callable[[], tuple[str, Frame]]] = {
    **{name: of_case(make) for name, make in cases.CASES.items()},
    **{make.__name__: make for make in (compared, discarded, ellipses, dropped, grid)},
}
COVERED = ("depths",)
"""Those whose picture is full."""


@pytest.fixture(params=FRAMES)
def drawn(request: pytest.FixtureRequest) -> tuple[str, Frame]:
    """A method's name, and a frame of it."""
    return FRAMES[request.param]()


def equal(found: NDArray[Any], value: Any) -> bool:
    return bool(
        np.array_equal(
            found, np.broadcast_to(np.asarray(value, found.dtype), found.shape), equal_nan=found.dtype.kind == "f"
        )
    )


def test_what_is_rendered_is_what_the_contract_has(drawn: tuple[str, Frame]) -> None:
    method, frame = drawn
    contract = contract_of(method)
    missing = [name for name, entry in contract.items() if name not in frame.stages and not entry.only]
    assert not missing
    assert not set(frame.stages) - set(contract)
    sizes: dict[str, int] = {"H": frame.depth.shape[0], "W": frame.depth.shape[1]}
    samples = frame.stages["project.shadow"].shape[:-2] if method == "shadows" else ()
    for name, stage in {"color": frame.color, "depth": frame.depth, **frame.stages}.items():
        entry = described(contract, name)
        assert isinstance(stage, tuple) == entry.paged, name
        for array in stage if entry.paged else [stage]:
            assert array.dtype.name == entry.dtype, name
            check_shape(
                name, array.shape, (*(samples if entry.per_sample else ()), *entry.shape), {} if entry.paged else sizes
            )


def check_shape(name: str, found: tuple[int, ...], wanted: tuple[str | int, ...], sizes: dict[str, int]) -> None:
    """Letters are the same sizes in all arrays of a frame (of an atlas: of one page)."""
    assert len(found) == len(wanted), name
    for size, letter in zip(found, wanted, strict=True):
        assert size == (sizes.setdefault(letter, size) if isinstance(letter, str) else letter), (name, found, wanted)


def pictures(contract: Mapping[str, StageArray], frame: Frame) -> dict[str, StageArray]:
    """The arrays of the picture's size."""
    return {name: contract[name] for name in frame.stages if contract[name].shape[:2] == ("H", "W")}


@pytest.mark.parametrize("name", [name for name in FRAMES if name not in COVERED])
def test_where_nothing_is(name: str) -> None:
    method, frame = FRAMES[name]()
    contract = contract_of(method)
    marks: dict[str, Callable[[], NDArray[np.bool_]]] = {
        "displacement": lambda: frame.stages["raster.face"] == -1,
        "splatting": lambda: frame.stages["raster.overdraw"] == 0,
        "shadows": lambda: frame.depth == 1.0,
    }
    empty = marks[method]()
    assert empty.any()
    assert not empty.all()
    for array_name, entry in pictures(contract, frame).items():
        assert entry.nothing is not None, array_name
        array = frame.stages[array_name]
        there = array[:, empty] if array.ndim == len(entry.shape) + 1 else array[empty]
        assert equal(there, entry.nothing), array_name
    assert equal(frame.depth[empty], IMAGE["depth"].blank)


def test_what_a_discarded_fragment_leaves() -> None:
    found = 0
    for make in (discarded, of_case(cases.displacement_maps)):
        _, frame = make()
        gone = (frame.stages["raster.face"] >= 0) & (frame.stages["march.hit_index"] == -1)
        found += int(gone.sum())
        for name, entry in pictures(displacement.contract.STAGES, frame).items():
            if entry.discarded != OWN:
                assert equal(frame.stages[name][gone], entry.discarded), name
            elif entry.dtype == "int32":
                assert (frame.stages[name][gone] >= 0).all(), name
            else:
                assert not np.isnan(frame.stages[name][gone]).any(), name
    assert found > 20


def test_what_a_dropped_point_leaves() -> None:
    _, frame = dropped()
    gone = np.isnan(frame.stages["vertex.depth"])
    assert gone.any()
    assert not gone.all()
    for name, entry in splatting.contract.STAGES.items():
        if entry.shape[0] == "V" and not entry.only and entry.discarded != OWN:
            assert equal(frame.stages[name][gone], entry.discarded), name
            assert not equal(frame.stages[name][~gone], entry.discarded), name


def test_beside_the_images_of_an_atlas() -> None:
    """Three on one page, the last of them less high."""
    frame = splatting.render(cases.splatting_cameras().scene)
    for name, entry in splatting.contract.STAGES.items():
        if not entry.paged:
            continue
        for number, page in enumerate(frame.stages[name]):
            beside = np.ones(page.shape[:2], np.bool_)
            for _, x, y, width, height in frame.stages["atlas.rects"][frame.stages["atlas.rects"][:, 0] == number]:
                beside[y : y + height, x : x + width] = False
            assert equal(page[beside], entry.nothing), name
    assert beside.any()


# --- The pages -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", methods.names())
def test_the_table_of_the_page_is_the_contract(method: str) -> None:
    (table,) = [section.text for section in pages.sections(method) if section.title == "Arrays"]
    rows = re.findall(r"^\| ([a-z]+(?:\.[a-z_]+)?) \| (.*) \|$", table, re.MULTILINE)
    found = {name: [part.strip() for part in row.split("|")] for name, row in rows if name != "name"}
    contract = contract_of(method)
    assert list(found) == list(contract)
    for name, entry in contract.items():
        nothing = entry.nothing_words.split("; also")[0] if entry.nothing is not None else ""
        assert found[name] == [entry.shape_words, entry.dtype, nothing, spelled(entry.discarded), entry.meaning], name
