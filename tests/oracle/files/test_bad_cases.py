"""Every file of a case's folder, bad in every way: one line that names it, and never a case."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref.io import write_image
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.files import changed_stages, load_case
from ibr_ref.oracle.files.manifest import digest_of_bytes
from ibr_ref.oracle.files.npy import digest
from tests.oracle.files import damage

pytestmark = pytest.mark.usefixtures("one_thread")


def refused(folder: Path, *words: str) -> str:
    """The error of loading, one line."""
    with pytest.raises((ValueError, OSError)) as error:
        load_case(folder)
    message = str(error.value)
    assert message
    assert "\n" not in message
    assert "Error" not in message
    for word in words:
        assert word in message, message
    return message


def spoiled(folder: Path, pattern: str, spoil: Callable[[Path], Any]) -> int:
    """Spoil each file of the folder in turn, and say how many; every one must be refused by its name."""
    count = 0
    for file in sorted(path for path in folder.rglob(pattern) if path.is_file()):
        with damage.spare(file):
            if spoil(file) is not False:
                refused(folder, file.name)
                count += 1
    return count


@pytest.mark.parametrize("way", damage.FILES)
def test_any_file(folder: Path, way: str) -> None:
    assert spoiled(folder, "*", damage.FILES[way]) > 20
    assert not damage.Ran.count


@pytest.mark.sampled(4)
@pytest.mark.parametrize("way", damage.ARRAYS)
def test_any_array(folder: Path, way: str) -> None:
    assert spoiled(folder, "*.npy", damage.ARRAYS[way]) > 15
    assert not damage.Ran.count


@pytest.mark.parametrize("way", [*damage.MAYBE, "another number"])
def test_any_array_to_which_it_applies(folder: Path, way: str) -> None:
    assert spoiled(folder, "*.npy", {**damage.MAYBE, "another number": damage.changed}[way]) > 8


def test_a_link_that_leads_out(folder: Path) -> None:
    (folder.parent / "outside.npy").write_bytes((folder / "expected" / "depth.npy").read_bytes())
    (folder / "expected" / "depth.npy").unlink()
    (folder / "expected" / "depth.npy").symlink_to(folder.parent / "outside.npy")
    refused(folder, "depth.npy", "out of the folder")


def test_a_linked_folder_that_leads_out(folder: Path) -> None:
    (folder / "expected").rename(folder.parent / "elsewhere")
    (folder / "expected").symlink_to(folder.parent / "elsewhere")
    refused(folder, "out of the folder")


def test_another_picture(folder: Path) -> None:
    write_image(folder / "expected" / "color.png", np.zeros((18, 24, 3)))
    refused(folder, "color.png")


def test_a_picture_that_claims_a_size(folder: Path) -> None:
    data = bytearray((folder / "expected" / "color.png").read_bytes())
    data[16:24] = (65535).to_bytes(4, "big") * 2
    (folder / "expected" / "color.png").write_bytes(bytes(data))
    refused(folder, "color.png", "65535")


def test_no_folder(tmp_path: Path) -> None:
    refused(tmp_path / "nowhere", "nowhere")
    (tmp_path / "file").write_text("x")
    refused(tmp_path / "file", "file", "no folder")
    (tmp_path / "empty").mkdir()
    refused(tmp_path / "empty", "case.json", "no such file")
    refused(tmp_path / ("x" * 300))


# --- Documents -------------------------------------------------------------------------------------------------------


def edit(folder: Path, change: Callable[[Any], None], name: str = "case.json") -> None:
    """Change a document, and make the manifest agree with it."""
    document = json.loads((folder / name).read_text())
    change(document)
    (folder / name).write_text(json.dumps(document))
    if name == "case.json":
        manifest = json.loads((folder / "manifest.json").read_text())
        manifest["documents"][name] = digest_of_bytes((folder / name).read_bytes())
        (folder / "manifest.json").write_text(json.dumps(manifest))


def put(*path: Any, value: Any) -> Callable[[Any], None]:
    """Set a field."""

    def change(document: Any) -> None:
        for part in path[:-1]:
            document = document[part]
        document[path[-1]] = value

    return change


DOCUMENTS: list[tuple[Callable[[Any], None], list[str]]] = [
    (put("format", value="something"), ["format"]),
    (put("version", value=2), ["version", "2"]),
    (put("extra", value=1), ["extra", "unknown field"]),
    (put("scene", "extra", value=1), ["scene.extra", "unknown field"]),
    (put("scene", "camera", "zoom", value=1), ["scene.camera.zoom", "unknown field"]),
    (put("params", "zoom", value=1), ["params.zoom", "unknown field"]),
    (put("expected", 0, "zoom", value=1), ["expected.0.zoom", "unknown field"]),
    (put("method", value="painting"), ["painting"]),
    (put("kind", value="hard"), ["kind", "hard"]),
    (put("profile", value="abacus"), ["profile", "abacus", "vulkan"]),
    (put("name", value="../x"), ["name", "../x"]),
    (put("name", value=3), ["name", "3"]),
    (put("scene", "camera", "near", value="1"), ["scene.camera.near", "'1'"]),
    (put("scene", "camera", "near", value=None), ["scene.camera.near"]),
    (put("scene", "camera", "near", value=True), ["scene.camera.near"]),
    (put("scene", "camera", "near", value=float("nan")), ["case.json"]),
    (put("scene", "camera", "width", value=0), ["scene.camera.width"]),
    (put("scene", "camera", "width", value=2.5), ["scene.camera.width"]),
    (put("scene", "camera", "width", value=10**30), ["scene.camera.width"]),
    (put("scene", "camera", "eye", value=[1, 2, 3]), ["scene.camera.eye"]),
    (put("scene", "camera", value=None), ["scene.camera"]),
    (put("scene", value=[]), ["scene"]),
    (put("params", value=None), ["params"]),
    (put("expected", value={}), ["expected"]),
    (put("expected", 0, "file", value="/etc/passwd"), ["expected.0.file", "/etc/passwd"]),
    (put("expected", 0, "file", value="expected/../../x.npy"), ["expected.0.file", "expected/../../x.npy"]),
    (put("expected", 0, "file", value="../color.npy"), ["expected.0.file"]),
    (put("expected", 0, "file", value="expected/sub/color.npy"), ["expected.0.file"]),
    (put("expected", 0, "file", value="expected\\color.npy"), ["expected.0.file"]),
    (put("expected", 0, "file", value="expected/.hidden"), ["expected.0.file"]),
    (put("expected", 0, "file", value="expected/x\n"), ["expected.0.file"]),
    (put("expected", 0, "file", value="expected/color.nope"), ["color.n"]),
    (put("expected", 0, "png", value="file:///etc/passwd"), ["expected.0.png"]),
    (put("expected", 0, "shape", value=[-1]), ["expected.0.shape"]),
    (put("expected", 0, "shape", value=[10**9, 10**9]), ["color.npy"]),
    (put("expected", 0, "dtype", value="object"), ["expected.0.dtype", "object"]),
    (put("scene", "camera", "clip_from_view_gl", 0, 0, value=9.0), ["scene.camera.clip_from_view_gl[0][0]", "9.0"]),
    (put("scene", "camera", "clip_from_view", 3, value=[0, 0, 0, 2]), ["clip_from_view"]),
    (put("scene", "background", value=[0.1, 0.2, 3.0]), ["background", "3.0"]),
]  # fmt: skip


@pytest.mark.parametrize(("change", "words"), DOCUMENTS)
def test_a_document(folder: Path, change: Callable[[Any], None], words: list[str]) -> None:
    edit(folder, change)
    refused(folder, *words)


def test_a_field_left_out(folder: Path) -> None:
    edit(folder, lambda document: document["scene"].pop("camera"))
    refused(folder, "scene.camera", "requires")


def test_a_derived_number_that_contradicts(folder: Path, full_case: Case) -> None:
    """What the reference does not read is compared all the same: ports read it."""
    change = {
        "displacement": put("scene", "polygons", 1, "patch_space", "rows", 0, 0, value=0.5),
        "splatting": put("scene", "images", 2, "camera", "clip_from_world", 1, 1, value=0.5),
        "shadows": put("scene", "light_samples", 3, "seen_offset", 0, value=0.5),
    }[full_case.method]
    edit(folder, change)
    refused(folder, "case.json: scene.", "0.5")


def test_params_that_are_not_allowed(folder: Path, full_case: Case) -> None:
    name, value = {
        "displacement": ("linear_steps", 0),
        "splatting": ("alpha", -1.0),
        "shadows": ("map_size", 7),
    }[full_case.method]
    edit(folder, put("params", name, value=value))
    refused(folder, name, str(value), "case.json")


@pytest.mark.parametrize("text", ["", "{", "[]", "null", "3", '"x"', "[" * 100000, "\ud800", "{}"])
@pytest.mark.parametrize("name", ["case.json", "manifest.json"])
def test_no_document(folder: Path, name: str, text: str) -> None:
    (folder / name).write_bytes(text.encode("utf-8", "surrogatepass"))
    refused(folder, name)


def test_an_edit_without_a_hash(folder: Path) -> None:
    text = (folder / "case.json").read_text()
    (folder / "case.json").write_text(text.replace("for the tests", "for no tests"))
    refused(folder, "case.json", "hash")


def test_a_manifest_with_another_hash(folder: Path) -> None:
    for name in json.loads((folder / "manifest.json").read_text())["arrays"]:
        shutil.copyfile(folder / "manifest.json", folder / "kept.json")
        edit(folder, put("arrays", name, value="0" * 64), "manifest.json")
        refused(folder, name.split("/")[1], "hash", "0000")
        shutil.move(folder / "kept.json", folder / "manifest.json")


@pytest.mark.parametrize(
    "change",
    [
        put("arrays", "expected/more.npy", value="0" * 64),
        put("arrays", "/etc/passwd", value="0" * 64),
        put("arrays", value={}),
        put("documents", "setup.py", value="0" * 64),
        put("documents", "case.json", value="nope"),
        put("documents", value={}),
        put("extra", value=1),
        put("version", value=7),
    ],
)
def test_a_manifest(folder: Path, change: Callable[[Any], None]) -> None:
    edit(folder, change, "manifest.json")
    refused(folder)


def test_a_stage_that_the_reference_draws_otherwise(folder: Path, full_case: Case) -> None:
    """Exchanged with its hash: the case loads, since what counts is drawn anew, and the stage is named."""
    damage.changed(folder / "expected" / "depth.npy")
    edit(folder, put("arrays", "expected/depth.npy", value=digest(np.load(folder / "expected" / "depth.npy"))),
         "manifest.json")  # fmt: skip
    case = load_case(folder)
    assert changed_stages(case, folder) == ["depth"]
    np.testing.assert_array_equal(case.frame.depth, full_case.frame.depth)


def test_loading_does_not_allocate_what_a_header_claims(folder: Path) -> None:
    import tracemalloc

    tracemalloc.start()
    damage.ARRAYS["a header of 10 GB and a file"](folder / "expected" / "depth.npy")
    refused(folder, "depth.npy")
    assert tracemalloc.get_traced_memory()[1] < 2**26
    tracemalloc.stop()
