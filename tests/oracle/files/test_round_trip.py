"""A case that was exported and loaded is the same case, to the last bit."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref.io import read_image
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.files import changed_stages, export, load_case, load_submission
from ibr_ref.oracle.schema.stages import expected
from ibr_ref.scene import Camera

pytestmark = pytest.mark.usefixtures("one_thread")


def cameras(scene: Any) -> list[Camera]:
    return [scene.camera, *(image.camera for image in getattr(scene, "images", ()))]


def test_the_reference_draws_the_same_bits(case: Case, tmp_path: Path) -> None:
    export(case, tmp_path / "case")
    loaded = load_case(tmp_path / "case")
    assert [getattr(loaded, name) for name in ("name", "method", "kind", "about", "profile")] == [
        case.name, case.method, case.kind, case.about, case.profile]  # fmt: skip
    ours, theirs = expected(case.frame), expected(loaded.frame)
    assert list(ours) == list(theirs)
    for name, array in ours.items():
        assert array.dtype == theirs[name].dtype
        assert array.tobytes() == theirs[name].tobytes(), name
    for one, other in zip(cameras(case.scene), cameras(loaded.scene), strict=True):
        for field in ("view_from_world", "clip_from_view", "world_from_view", "eye", "intrinsics"):
            assert getattr(one, field).tobytes() == getattr(other, field).tobytes(), field
        assert one.afx == other.afx
    assert not changed_stages(loaded, tmp_path / "case")


def test_params_come_back(case: Case, tmp_path: Path) -> None:
    export(case, tmp_path / "case")
    loaded = load_case(tmp_path / "case")
    for name in type(case.params).__dataclass_fields__:
        np.testing.assert_array_equal(getattr(case.params, name), getattr(loaded.params, name))


def test_given_normals_come_back(tmp_path: Path) -> None:
    from tests.oracle.files.cases import splatting_colors

    case = splatting_colors()
    export(case, tmp_path / "case")
    (normals,) = load_case(tmp_path / "case").inputs["normals"]
    np.testing.assert_array_equal(normals, case.inputs["normals"][0])


def test_two_exports_are_the_same_bytes(case: Case, tmp_path: Path) -> None:
    contents = []
    for name in ("one", "two"):
        export(case, tmp_path / name)
        files = sorted(path for path in (tmp_path / name).rglob("*") if path.is_file())
        contents.append({path.relative_to(tmp_path / name): path.read_bytes() for path in files})
    assert contents[0] == contents[1]


def test_what_another_language_sees(full_case: Case, tmp_path: Path) -> None:
    """The folder read with NumPy, json and hashlib alone, as the manifest says."""
    export(full_case, tmp_path / "case")
    document = json.loads((tmp_path / "case" / "case.json").read_text())
    manifest = json.loads((tmp_path / "case" / "manifest.json").read_text())
    for stage in document["expected"]:
        array = np.load(tmp_path / "case" / stage["file"], allow_pickle=False)
        assert array.flags.c_contiguous
        assert (list(array.shape), array.dtype.name) == (stage["shape"], stage["dtype"])
        assert stage["meaning"]
        line = f"{array.dtype.str} {','.join(map(str, array.shape))}\n".encode()
        assert hashlib.sha256(line + array.tobytes()).hexdigest() == manifest["arrays"][stage["file"]]
    for name, hash_ in manifest["documents"].items():
        assert hashlib.sha256((tmp_path / "case" / name).read_bytes()).hexdigest() == hash_
    present = {p.relative_to(tmp_path / "case").as_posix() for p in (tmp_path / "case").rglob("*") if p.is_file()}
    assert present == {*manifest["arrays"], *manifest["documents"], "manifest.json"}
    color = read_image(tmp_path / "case" / "expected" / "color.png")
    np.testing.assert_array_equal(255 * color, np.floor(255 * np.clip(full_case.frame.color, 0, 1) + 0.5))


def test_bytes_are_stored_as_bytes(maps_case: Case, tmp_path: Path) -> None:
    """A map of k / 255 is written as k, with a PNG; another one as it is."""
    export(maps_case, tmp_path / "case")
    first, second = json.loads((tmp_path / "case" / "case.json").read_text())["scene"]["polygons"]
    assert (second["height_map"]["dtype"], second["height_map"]["values"]) == ("uint8", "k / 255")
    assert (first["normal_map"]["dtype"], first["normal_map"]["png"]) == ("float64", None)
    codes = np.load(tmp_path / "case" / second["height_map"]["file"])
    np.testing.assert_array_equal(codes / 255.0, maps_case.scene.polygons[1].height_map)
    np.testing.assert_array_equal(codes / 255.0, read_image(tmp_path / "case" / second["height_map"]["png"]))


def test_the_gl_matrix_gives_the_same_window_depth(case: Case, tmp_path: Path) -> None:
    export(case, tmp_path / "case")
    camera = json.loads((tmp_path / "case" / "case.json").read_text())["scene"]["camera"]
    point = np.array([0.3, -0.2, -3.0, 1.0])
    _, _, z, w = np.array(camera["clip_from_view"]) @ point
    x_gl, y_gl, z_gl, w_gl = np.array(camera["clip_from_view_gl"]) @ point
    assert (z_gl / w_gl + 1) / 2 == pytest.approx(z / w, abs=1e-14)
    assert (z_gl / w_gl + 1) / 2 != pytest.approx(z_gl / w_gl, abs=1e-6)
    world = np.array(camera["clip_from_world_gl"]) @ np.array(camera["world_from_view"]) @ point
    np.testing.assert_allclose(world, [x_gl, y_gl, z_gl, w_gl], atol=1e-12)
    for edge, depth in ((camera["near"], 0.0), (camera["far"], 1.0)):
        _, _, z, w = np.array(camera["clip_from_view"]) @ [0.0, 0.0, -edge, 1.0]
        assert z / w == pytest.approx(depth, abs=1e-12)


def test_light_samples_are_listed_in_order(tmp_path: Path) -> None:
    from tests.oracle.files.cases import shadows_warped

    case = shadows_warped()
    export(case, tmp_path / "case")
    samples = json.loads((tmp_path / "case" / "case.json").read_text())["scene"]["light_samples"]
    assert len(samples) == 5
    centre, half = case.scene.light.arrays
    assert samples[0]["position"] == centre.tolist()
    np.testing.assert_allclose(samples[1]["position"], centre - (half[0] + half[1]) * 2 / 3)
    for sample in samples:
        assert sample["camera"]["eye"] == [*sample["position"], 1.0]
        offset = np.subtract(case.scene.offset, sample["displacement"])
        np.testing.assert_allclose(sample["seen_offset"], offset)


def test_the_expected_folder_is_a_submission(full_case: Case, tmp_path: Path) -> None:
    export(full_case, tmp_path / "case")
    (tmp_path / "case" / "expected" / "color.png").unlink()
    submission = load_submission(tmp_path / "case" / "expected", full_case)
    assert submission.usable, submission.problems
    assert set(submission.handed) == {"color", "depth", *full_case.frame.stages}
