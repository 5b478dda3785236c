"""What ports may hand in, and how referees get it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref.io import write_image
from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.arithmetic.device import Arithmetic, Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.files import Submission, load_submission, submission_from_arrays

pytestmark = pytest.mark.usefixtures("one_thread")


def only(submission: Submission, *words: str) -> None:
    """It has one problem, with these words in it."""
    assert len(submission.problems) == 1, submission.problems
    for word in words:
        assert word in str(submission.problems[0])


def test_the_final_image_alone(maps_case: Case, tmp_path: Path) -> None:
    maps_case.frame.save(tmp_path / "color.png")
    submission = load_submission(tmp_path, maps_case)
    assert submission.usable
    assert list(submission.handed) == ["color"]
    assert submission.handed["color"].dtype == np.uint8
    np.testing.assert_array_equal(submission.handed["color"], color_bytes(maps_case.frame.color))
    assert submission.profile is None


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_floats_that_were_bytes_are_bytes(maps_case: Case, dtype: type) -> None:
    """A framebuffer of bytes that was read back as floats: rounded by its conversion, like a PNG."""
    codes = color_bytes(maps_case.frame.color)
    handed = submission_from_arrays(maps_case, color=(codes / 255.0).astype(dtype)).handed["color"]
    assert handed.dtype == np.uint8
    np.testing.assert_array_equal(handed, codes)


@pytest.mark.parametrize("policy", [Policy(reciprocal=True), Policy(loose=2), Policy(jitter=2), Policy(truncated=True)])
def test_whatever_quotient_a_device_makes_of_them(maps_case: Case, policy: Policy) -> None:
    codes = np.arange(maps_case.frame.color.size).reshape(maps_case.frame.color.shape) % 256
    handed = submission_from_arrays(maps_case, color=Arithmetic(policy).divide(codes, 255.0)).handed["color"]
    assert handed.dtype == np.uint8
    np.testing.assert_array_equal(handed, codes)


@pytest.mark.parametrize("other", [100.0 / 255.0 + 1e-6, -1.0 / 255.0, 256.0 / 255.0])
def test_one_other_float_makes_it_a_picture_of_floats(maps_case: Case, other: float) -> None:
    color = (color_bytes(maps_case.frame.color) / 255.0).astype(np.float32)
    color[3, 4, 1] = other
    handed = submission_from_arrays(maps_case, color=color).handed["color"]
    assert handed.dtype == np.float64
    np.testing.assert_array_equal(handed, color)


def test_all_in_one_archive(full_case: Case, tmp_path: Path) -> None:
    full_case.frame.save_stages(tmp_path / "all.npz")
    for place in (tmp_path, tmp_path / "all.npz"):
        submission = load_submission(place, full_case)
        assert submission.usable, submission.problems
        for name, stage in full_case.frame.stages.items():
            ours = stage if isinstance(stage, tuple) else (stage,)
            theirs = submission.handed[name]
            for one, other in zip(ours, theirs if isinstance(theirs, tuple) else (theirs,), strict=True):
                np.testing.assert_array_equal(one, other)
                assert one.dtype == other.dtype


def test_arrays_in_memory_are_the_same_as_files(full_case: Case, tmp_path: Path) -> None:
    frame = full_case.frame
    submission = submission_from_arrays(full_case, color=frame.color, depth=frame.depth, stages=frame.stages)
    assert submission.usable, submission.problems
    assert set(submission.handed) == {"color", "depth", *frame.stages}


def test_the_profile(maps_case: Case, tmp_path: Path) -> None:
    maps_case.frame.save(tmp_path / "color.png")
    (tmp_path / "port.json").write_text('{"profile": "webgpu"}')
    assert load_submission(tmp_path, maps_case).profile == "webgpu"
    assert submission_from_arrays(maps_case, color=maps_case.frame.color, profile="gl").profile == "gl"
    with pytest.raises(ValueError, match="abacus"):
        submission_from_arrays(maps_case, color=maps_case.frame.color, profile="abacus")


def test_types_are_those_of_the_contract(maps_case: Case) -> None:
    frame = maps_case.frame
    stages = {
        "march.hit": frame.stages["march.hit"].astype(np.float32),
        "march.hit_index": frame.stages["march.hit_index"].astype(np.int64),
        "raster.face": frame.stages["raster.face"].astype(np.int8),
        "march.steep": frame.stages["march.steep"].astype(np.uint8),
    }
    submission = submission_from_arrays(maps_case, color=frame.color.astype(np.float32), stages=stages)
    assert submission.usable, submission.problems
    dtypes = {name: array.dtype.name for name, array in submission.handed.items()}
    assert dtypes == {
        "color": "float64",
        "march.hit": "float64",
        "march.hit_index": "int32",
        "raster.face": "int32",
        "march.steep": "bool",
    }
    np.testing.assert_array_equal(submission.handed["march.steep"], frame.stages["march.steep"])


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        ("march.hit_index", lambda a: a.astype(np.float32), ["float32", "integers"]),
        ("march.hit_index", lambda a: a.astype(np.uint32), ["4294967295", "2147483647"]),
        ("march.steep", lambda a: a.astype(np.float32), ["float32", "booleans"]),
        ("march.steep", lambda a: a.astype(np.uint8) * 255, ["255", "0 to 1"]),
        ("march.hit", lambda a: np.nan_to_num(a).astype(np.int32), ["int32", "float32 or float64"]),
        ("march.hit", lambda a: a.astype(np.float16), ["float16"]),
        ("march.hit", lambda a: np.swapaxes(a, 0, 1), ["(24, 18, 3)", "exchanged"]),
        ("march.hit", lambda a: a[..., :2], ["(18, 24, 2)", "(18, 24, 3)"]),
        ("march.hit", lambda a: a.astype(complex), ["complex128"]),
        ("march.hit", lambda a: a.tolist(), ["list"]),
        ("march.hit", lambda a: "march.hit", ["str"]),
        ("march.hitindex", lambda a: 0, ["march.hitindex", "march.hit_index, perhaps"]),
        ("nonsense", lambda a: 0, ["nonsense"]),
    ],
)
def test_other_types_and_shapes(maps_case: Case, name: str, change: Any, words: list[str]) -> None:
    array = change(maps_case.frame.stages.get(name))
    array = np.zeros(3) if isinstance(array, int) else array
    submission = submission_from_arrays(maps_case, color=maps_case.frame.color, stages={name: array})
    only(submission, name, *words)


def test_alpha_is_not_looked_at(maps_case: Case) -> None:
    image = np.dstack([color_bytes(maps_case.frame.color), np.zeros((18, 24), np.uint8)])
    submission = submission_from_arrays(maps_case, color=image)
    np.testing.assert_array_equal(submission.handed["color"], image[..., :3])


class Device:
    """An array of another library."""

    def __init__(self, array: Any, fails: bool = False) -> None:
        self.array, self.fails = array, fails

    def __dlpack__(self, **options: Any) -> Any:
        if self.fails:
            raise BufferError("it is\non the GPU")
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self) -> Any:
        return self.array.__dlpack_device__()


class Convertible:
    """One with `__array__` alone."""

    def __init__(self, array: Any) -> None:
        self.array = array

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return self.array


def test_arrays_of_other_libraries(maps_case: Case) -> None:
    color = maps_case.frame.color.astype(np.float32)
    for array in (Device(color), Convertible(color), np.asfortranarray(color), color.astype(">f4")):
        submission = submission_from_arrays(maps_case, color=array)
        np.testing.assert_array_equal(submission.handed["color"], color)
    only(submission_from_arrays(maps_case, color=Device(color, fails=True)), "color", "gives no array", "CPU")


def test_handed_arrays_are_copies(maps_case: Case) -> None:
    color = color_bytes(maps_case.frame.color)
    submission = submission_from_arrays(maps_case, color=color)
    color[:] = 0
    assert submission.handed["color"].any()
    with pytest.raises(ValueError, match="read-only"):
        submission.handed["color"][:] = 0


def test_pages_by_their_numbers(tmp_path: Path) -> None:
    from tests.oracle.files.cases import splatting_cameras

    case = splatting_cameras()
    pages = case.frame.stages["atlas.color"]
    assert len(pages) > 1
    numbered = {f"atlas.color.{i}": page for i, page in enumerate(pages)}
    assert submission_from_arrays(case, color=case.frame.color, stages=numbered).usable
    del numbered["atlas.color.1"]
    only(submission_from_arrays(case, color=case.frame.color, stages=numbered), "atlas.color.1", "all pages")
    only(submission_from_arrays(case, color=case.frame.color, stages={"atlas.color": pages[0]}), "atlas.color")


def test_files_that_do_not_count(maps_case: Case, tmp_path: Path) -> None:
    maps_case.frame.save(tmp_path / "color.png")
    for name in ("notes.txt", "screenshot.png", ".hidden.npy", "main.cpp"):
        (tmp_path / name).write_text("whatever")
    (tmp_path / "build").mkdir()
    assert load_submission(tmp_path, maps_case).usable


def test_a_file_by_an_unknown_name(maps_case: Case, tmp_path: Path) -> None:
    maps_case.frame.save(tmp_path / "color.png")
    np.save(tmp_path / "colour.npy", maps_case.frame.color)
    only(load_submission(tmp_path, maps_case), "colour.npy", "color, perhaps")


@pytest.mark.parametrize("kind", ["grey", "16 bits", "turned", "jpeg"])
def test_other_pictures(maps_case: Case, tmp_path: Path, kind: str) -> None:
    color, path = maps_case.frame.color, tmp_path / "color.png"
    if kind == "grey":
        write_image(path, color[..., 0])
    elif kind == "turned":
        write_image(path, color.swapaxes(0, 1))
    elif kind == "jpeg":
        write_image(tmp_path / "x.jpg", color)
        (tmp_path / "x.jpg").rename(path)
    else:
        from tests.io.png_writer import encode

        samples = np.floor(65535 * color + 0.5).astype(np.uint16)
        path.write_bytes(encode(samples, 16))
    only(load_submission(tmp_path, maps_case), "color.png", "exchanged" if kind == "turned" else "")
