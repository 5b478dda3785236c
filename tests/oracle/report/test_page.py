"""The report: one file that needs nothing else, and what a browser makes of it."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref.displacement import render
from ibr_ref.oracle import report
from ibr_ref.oracle.examination import Examination, examine
from ibr_ref.oracle.findings import Outcome, TraceStep
from ibr_ref.oracle.report import numbers
from ibr_ref.oracle.report.page import folded
from ibr_ref.oracle.report.shift import shift
from tests import browser
from tests.browser import Page
from tests.oracle.plain_referee import box_case, judges_all


@pytest.fixture(scope="module")
def failed() -> Examination:
    """A port whose search goes wrong in a square."""
    patch = pytest.MonkeyPatch()
    judges_all(patch)
    case = box_case()
    frame = case.frame
    handed = {"color": np.floor(255 * frame.color + 0.5).astype(np.uint8)}
    handed |= {name: array.copy() for name, array in frame.stages.items() if name.startswith(("raster", "march"))}
    handed["march.hit_index"][30:42, 40:60] += 1
    handed["color"][30:42, 40:60] = (255, 0, 255)
    examination = examine(case, handed)
    patch.undo()
    return examination


def test_the_page_is_self_contained(failed: Examination) -> None:
    text = report.page(failed)
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:)""", text)
    assert not re.search(r"https?://|url\(|@import", text)
    assert "default-src 'none'" in text
    assert text.count("data:image/png;base64,") == 4  # reference, port, status, the stage
    for part in ("FAIL", "march.hit_index in 240", "Witness: pixel", "h &lt; H"):
        assert part in text


def test_markup_in_names_is_text(failed: Examination) -> None:
    """A case's words and a port's names may hold anything."""
    case = dataclasses.replace(failed.case, about="</script><script>alert(1)</script>")
    handed = {**failed.handed, "march.</script>": failed.handed["march.steep"]}
    text = report.page(dataclasses.replace(failed, case=case, handed=handed))
    assert "<script>alert" not in text
    assert text.count("</script>") == 2


def test_the_file_is_written_whole_or_not_at_all(failed: Examination, tmp_path: Path) -> None:
    report.write(failed, tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text("utf-8") == report.page(failed)
    with pytest.raises(FileNotFoundError, match="does not exist"):
        report.write(failed, tmp_path / "no" / "report.html")
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


@pytest.fixture(scope="module")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    if browser.PROGRAM is None:
        pytest.skip(browser.MISSING)
    with browser.browser(tmp_path_factory.mktemp("browser")) as page:
        yield page


@pytest.fixture
def page(failed: Examination, chromium: Page, tmp_path: Path) -> Iterator[Page]:
    report.write(failed, tmp_path / "report.html")
    chromium.open((tmp_path / "report.html").as_uri())
    yield chromium
    assert chromium.faults == []


def look(page: Page, x: int, y: int) -> dict[str, tuple[str, str, bool]]:
    """The inspector's rows of a pixel, as the mouse finds it: reference, port, whether it is red."""
    page.value("viewer.scrollIntoView()")
    left, top, width, height = page.box("#viewer")
    columns, rows = page.value("[picture.width, picture.height]")
    page.mouse("mouseMoved", left + (x + 0.5) / columns * width, top + (y + 0.5) / rows * height)
    page.wait(f"document.getElementById('place').textContent === '{x}, {y}'")
    page.value("new Promise((r) => setTimeout(r, 50))")
    found = page.value(
        "Array.from(document.querySelectorAll('#values tr'), r => [...Array.from(r.cells, c => c.textContent),"
        " r.classList.contains('wrong')])"
    )
    return {name: (ours, theirs, wrong) for name, ours, theirs, wrong in found}


def picture(page: Page) -> np.ndarray:
    """(H, W, 3) as it is shown."""
    of = "Array.from(picture.getContext('2d').getImageData(0, 0, picture.width, picture.height).data)"
    columns, rows = page.value("[picture.width, picture.height]")
    return np.array(page.value(of), np.uint8).reshape(rows, columns, 4)[..., :3].astype(int)


def test_the_inspector_shows_reference_and_port(page: Page, failed: Examination) -> None:
    index = failed.case.frame.stages["march.hit_index"][33, 45]
    found = look(page, 45, 33)
    assert page.text("#status") == "wrong"
    assert found["march.hit_index"] == (str(index), str(index + 1), True)
    assert found["color"][1:] == ("1, 0, 1", True)
    assert found["shade.normal"][1] == ""
    assert found["raster.face"][0] == found["raster.face"][1]
    assert sorted(name for name, (*_, wrong) in found.items() if wrong) == ["color", "march.hit_index"]
    assert not any(wrong for *_, wrong in look(page, 3, 60).values())
    assert page.text("#status") == "right"
    look(page, 45, 1)
    assert page.text("#status") == "undecided"


def test_every_number_is_the_arrays_own(page: Page, failed: Examination) -> None:
    """To float32, at places of other tiles, of which the last ones are not whole."""
    for x, y in ((0, 0), (95, 71), (50, 40), (16, 15)):
        found = look(page, x, y)
        for name, (ours, theirs) in numbers.planes(failed).items():
            for said, array in zip(found[name], (ours, theirs), strict=False):
                if array is not None:
                    values = np.atleast_1d(array[y, x]).astype(np.float64)
                    seen = [float(value) for value in said.replace("Infinity", "inf").split(", ")]
                    assert np.allclose(seen, values, rtol=1e-6, atol=1e-7, equal_nan=True), name


def test_the_page_opens_on_the_witness(page: Page, failed: Examination) -> None:
    row, column = failed.verdict.witness.index  # type: ignore[union-attr]
    assert page.text("#place") == f"{column}, {row}"


def test_pictures_seam_and_gain(page: Page, failed: Examination) -> None:
    """Magenta, which only the port has, is seen where the seam is left of it, and not where it is right of it."""
    for percent, seen in ((0, True), (100, False)):
        page.value(f"slider.value = {percent}, slider.dispatchEvent(new Event('input'))")
        assert (picture(page)[35, 50].tolist() == [255, 0, 255]) == seen
    ours, theirs = np.floor(255 * failed.case.frame.color + 0.5), failed.handed["color"]
    off = np.abs(ours.astype(int) - theirs)
    for times in (1, 3):
        page.value(f"gain.value = {times}, gain.dispatchEvent(new Event('input'))")
        assert np.array_equal(picture(page), np.minimum(times * off, 255))
        assert page.text("#times") == f"{times} times"
    page.value("document.querySelector('[data-layer=marks]').click()")
    assert picture(page)[35, 50].tolist() == [255, 32, 64]
    assert picture(page)[1, 3].tolist() == [255, 176, 0]


def noisy(examination: Examination) -> Examination:
    """The same with a port whose numbers are all wrong."""
    random = np.random.default_rng(0)
    frame = examination.case.frame
    handed = {"color": random.integers(0, 256, frame.color.shape).astype(np.uint8)}
    for name, array in frame.stages.items():
        if array.dtype == np.float64 and array.shape[:2] == frame.depth.shape:
            handed[name] = random.normal(size=array.shape)
    return dataclasses.replace(examination, handed=handed)


@pytest.mark.long
def test_a_page_stays_small(failed: Examination) -> None:
    """Of 640 x 480 random pixels three megabytes, and whatever fits of the numbers."""
    camera = dataclasses.replace(failed.case.scene.camera, width=640, height=480, intrinsics=None)
    case = dataclasses.replace(failed.case, scene=dataclasses.replace(failed.case.scene, camera=camera))
    wrong = np.zeros((480, 640), bool)
    wrong[100:104, 200:300] = True
    arrays = {"wrong": wrong, "undecided": np.zeros_like(wrong), "width": np.zeros(wrong.shape)}
    arrays["blame"] = np.where(wrong, 0, -1).astype(np.int8)
    judgements = [dataclasses.replace(judgement, **arrays) for judgement in failed.judgements]
    large = noisy(dataclasses.replace(failed, case=case, judgements=judgements))
    assert len(report.page(large)) <= 3 * 2**20
    data = numbers.packed(large, 400_000)
    across = 640 // numbers.TILE
    inside = {row * across + column for row in (6,) for column in range(200 // 16, 300 // 16 + 1)}
    assert inside <= set(data["kept"])
    assert len(data["kept"]) < data["tiles"]


def test_places_without_numbers_say_so(
    failed: Examination, chromium: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = import_module("ibr_ref.oracle.report.page")  # the package has a function of that name
    monkeypatch.setattr(module, "MOST_CHARACTERS", 0)
    monkeypatch.setattr(module, "LEAST_NUMBERS", 6000)
    report.write(failed, tmp_path / "report.html")
    chromium.open((tmp_path / "report.html").as_uri())
    assert look(chromium, 40, 30)
    assert not look(chromium, 3, 70)
    assert "ibr-ref view case" in chromium.text("#left-out")


def moved(examination: Examination, across: float, down: float) -> Examination:
    """A port that samples elsewhere."""
    scene = examination.case.scene
    clip = scene.camera.clip_from_view.copy()
    clip[0] += 2 * across / scene.camera.width * clip[3]
    clip[1] -= 2 * down / scene.camera.height * clip[3]
    camera = dataclasses.replace(scene.camera, clip_from_view=clip, intrinsics=None)
    frame = render(dataclasses.replace(scene, camera=camera), examination.case.params)
    handed = {name: array for name, array in frame.stages.items() if name.startswith("raster.")}
    off = np.abs(handed["raster.patch"] - examination.case.frame.stages["raster.patch"]).max(axis=-1) > 1e-9
    judgement = dataclasses.replace(examination.judgements[0], arrays=("raster.patch",), wrong=off)
    return dataclasses.replace(examination, handed=handed, judgements=[judgement])


def test_a_shift_of_the_raster_is_measured(failed: Examination) -> None:
    found = shift(moved(failed, -0.5, 0.25))
    assert found is not None
    # The picture moved to the left: each pixel has what lay to its right.
    assert found.median == pytest.approx((0.5, -0.25), abs=0.02)
    assert found.explained > 0.8 * found.wrong
    assert found.picture.shape == (72, 96, 3)
    assert "raster.patch is as if" in report.page(moved(failed, -0.5, 0.25))
    assert shift(failed) is None


def test_equal_rows_are_folded() -> None:
    pairs = [("a", ""), *[("b", "b")] * 5, ("c", "d"), ("e", "e")]
    rows = [TraceStep(step="", reference=ours, port=theirs) for ours, theirs in pairs]
    assert [(fold, len(group)) for fold, group in folded(rows)] == [(False, 1), (True, 5), (False, 1), (False, 1)]


def test_a_page_of_all_cases(failed: Examination, chromium: Page, tmp_path: Path) -> None:
    verdict: Any = failed.verdict
    entries = [
        report.entry("displacement-b", verdict, 2.5, failed),
        report.entry(
            "displacement-a <b>", verdict.model_copy(update={"outcome": Outcome.PASS, "stages": ()}), 10.0, None
        ),
    ]
    report.write_run(entries, tmp_path)
    text = (tmp_path / "index.html").read_text("utf-8")
    assert "a &lt;b&gt;" in text
    assert not re.search(r"https?://|url\(|@import", text)
    chromium.open((tmp_path / "index.html").as_uri())
    names = "Array.from(document.querySelectorAll('tbody tr'), r => r.cells[2].textContent.trim())"
    assert chromium.value(names) == ["displacement-b", "displacement-a <b>"]
    for column, clicks, first in ((2, 1, "displacement-a <b>"), (9, 1, "displacement-b"), (9, 1, "displacement-a <b>")):
        for _ in range(clicks):
            chromium.value(f"document.querySelectorAll('th')[{column}].querySelector('button').click()")
        assert chromium.value(names)[0] == first
    assert chromium.value("document.querySelector('tbody a').getAttribute('href')") == "displacement-b.html"
    assert chromium.faults == []
