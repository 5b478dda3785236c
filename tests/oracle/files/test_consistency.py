"""`case.json`, its arrays and its pictures: whatever follows from something else in the folder is compared with it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref import Camera
from ibr_ref.io import write_image
from ibr_ref.oracle import cases
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.files import export, load_case
from ibr_ref.oracle.files.npy import digest, write_array
from ibr_ref.oracle.schema.camera import contradiction
from tests.oracle.files.test_bad_cases import edit, put, refused

pytestmark = pytest.mark.usefixtures("one_thread")

Path_ = tuple[Any, ...]


def cameras(document: Any, path: Path_ = ()) -> Iterator[Path_]:
    """Where the document has cameras."""
    if isinstance(document, dict) and "clip_from_view" in document:
        yield path
        return
    parts = (
        document.items() if isinstance(document, dict) else enumerate(document) if isinstance(document, list) else ()
    )
    for name, part in parts:
        yield from cameras(part, (*path, name))


def numbers(part: Any, path: Path_ = ()) -> Iterator[tuple[Path_, float]]:
    """All numbers of a part, and where they are."""
    if isinstance(part, (int, float)) and not isinstance(part, bool):
        yield path, part
    parts = part.items() if isinstance(part, dict) else enumerate(part) if isinstance(part, list) else ()
    for name, item in parts:
        yield from numbers(item, (*path, name))


def at(document: Any, path: Path_) -> Any:
    for name in path:
        document = document[name]
    return document


def written(path: Path_) -> str:
    """As errors have it: scene.images[2].camera."""
    return "".join(f"[{name}]" if isinstance(name, int) else f".{name}" for name in path)[1:]


def tried(folder: Path, path: Path_, value: Any, blamed: str = "case.json: scene.") -> str:
    """The error of loading with that value, and the folder as it was afterwards."""
    kept = {name: (folder / name).read_bytes() for name in ("case.json", "manifest.json")}
    edit(folder, put(*path, value=value))
    try:
        return refused(folder, blamed)
    finally:
        for name, data in kept.items():
            (folder / name).write_bytes(data)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("change", [1.0 + 1e-9, 1.5])
@pytest.mark.parametrize("field", ["near", "far"])
def test_planes_of_every_camera(folder: Path, field: str, change: float) -> None:
    document = json.loads((folder / "case.json").read_text())
    found = list(cameras(document))
    assert len(found) >= {"displacement": 1, "splatting": 3, "shadows": 4}[document["method"]]
    for path in found:
        message = tried(folder, (*path, field), at(document, path)[field] * change)
        # With the fields of axis_angle all matrices are made anew, of near and far as they are.
        assert any(f"{written(path)}.{name}" in message for name in (field, "clip_from_view")), message


@pytest.mark.parametrize("axis", range(3))
def test_the_eye_of_every_camera(folder: Path, axis: int) -> None:
    document = json.loads((folder / "case.json").read_text())
    for path in cameras(document):
        eye = at(document, path)["eye"]
        for step in (1e-9 * max(map(abs, eye)), 0.25):
            message = tried(folder, (*path, "eye"), [v + step * (i == axis) for i, v in enumerate(eye)])
            assert f"{written(path)}.eye" in message, message


def test_every_number_of_a_camera(folder: Path) -> None:
    """Whichever is changed, it contradicts the others."""
    document = json.loads((folder / "case.json").read_text())
    path = next(cameras(document))
    every = list(numbers(at(document, path)))
    assert len(every) > 110
    for inner, value in every:
        tried(folder, (*path, *inner), value + 1 if isinstance(value, int) else value * 1.001 + 1e-3)


DERIVED = {
    "displacement": [("scene", "polygons", 0, "patch_space"), ("scene", "light", "homogeneous")],
    "splatting": [("scene", "light", "homogeneous")],
    "shadows": [("scene", "light_samples", 1), ("scene", "light", "near"), ("scene", "light", "vertical_fov")],
}


def test_every_number_that_follows(folder: Path) -> None:
    document = json.loads((folder / "case.json").read_text())
    for path in DERIVED[document["method"]]:
        for inner, value in numbers(at(document, path)):
            # The light's own numbers contradict the maps that were made under it, too: either may be found first.
            tried(folder, (*path, *inner), value + 1 if isinstance(value, int) else value * 1.001 + 1e-3, "case.json: ")


@pytest.mark.parametrize("name", cases.names())
def test_no_case_contradicts_itself(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The bounds of rounding are wide enough for every way in which cameras are made."""
    found = vars(cases.build(name).scene)
    made = [found["camera"], *(image.camera for image in found.get("images", ()))]
    assert all(contradiction(camera) is None for camera in made)


CAMERA: dict[str, Any] = {"near": 0.5, "far": 7.0, "width": 12, "height": 8}


@pytest.mark.parametrize("seed", range(200))
def test_cameras_agree_with_themselves(seed: int) -> None:
    random = np.random.default_rng(seed)
    scale = 10.0 ** random.uniform(-6, 6)
    eye, target = scale * random.normal(size=(2, 3))
    near = 10.0 ** random.uniform(-4, 1)
    planes = {**CAMERA, "near": near, "far": near * (1 + 10.0 ** random.uniform(-3, 8))}
    turned, _ = np.linalg.qr(random.normal(size=(3, 3)))
    turned *= np.sign(np.linalg.det(turned))
    first = Camera.calibrated(
        intrinsics=[[300.0, 0.3, 5.0], [0, 290.0, 4.0], [0, 0, 1]],
        rotation=turned + 1e-5 * random.normal(size=(3, 3)),
        translation=scale * random.normal(size=3),
        **planes,
    )
    second = replace_translation(first, random.normal(size=3) * scale)
    made = [
        Camera.look_at(eye=eye, target=target, **planes),
        Camera.orthographic(eye=eye, target=target, view_height=2.0, **planes),
        Camera.axis_angle(position=eye, orientation=(*random.normal(size=3), 1.0), field_of_view=(0.5, 0.4), **planes),
        first,
        Camera.between(first, second, 0.3),
    ]
    for camera in made:
        assert contradiction(camera) is None
        assert (contradiction(replace(camera, near=camera.near * 1.001)) or ("",))[0] in ("near", "far")
        moved = camera.eye + np.array([1e-6 * np.abs(camera.eye).max(), 0, 0, 0])
        assert (contradiction(replace(camera, eye=moved)) or ("",))[0] == "eye"


def replace_translation(camera: Camera, translation: Any) -> Camera:
    return Camera.calibrated(
        intrinsics=camera.intrinsics,
        rotation=camera.view_from_world[:3, :3],
        translation=translation,
        near=camera.near,
        far=camera.far,
        width=camera.width,
        height=camera.height,
    )


def test_a_contradicting_camera_is_not_exported(maps_case: Case, tmp_path: Path) -> None:
    camera = replace(maps_case.scene.camera, near=maps_case.scene.camera.near * 2)
    with pytest.raises(ValueError, match=r"camera\.near: found .*, allowed: .*clip_from_view"):
        export(replace(maps_case, scene=replace(maps_case.scene, camera=camera)), tmp_path / "case")
    assert not list(tmp_path.iterdir())


def test_a_picture_that_is_not_its_array(folder: Path) -> None:
    """With the right hash."""
    for png in sorted(folder.rglob("*.png")):
        data, manifest = png.read_bytes(), (folder / "manifest.json").read_text()
        from ibr_ref.io import read_image

        codes = np.rint(255 * read_image(png)).astype(np.uint8)
        codes[-1, -1] ^= 255
        write_image(png, codes / 255.0)
        changed = json.loads(manifest)
        changed["arrays"][png.relative_to(folder).as_posix()] = digest(codes)
        (folder / "manifest.json").write_text(json.dumps(changed))
        refused(folder, png.name, f"as in {png.relative_to(folder).as_posix().removesuffix('png')}npy")
        png.write_bytes(data)
        (folder / "manifest.json").write_text(manifest)
    load_case(folder)


@pytest.mark.parametrize(
    ("index", "field", "value", "word"),
    [
        (0, "group", "raster", "expected[0].group"),
        (1, "kind", "margin", "expected[1].kind"),
        (1, "name", "color", "each name once"),
        (1, "name", "nothing.at.all", "the arrays of"),
        (0, "png", None, "expected[0].png"),
    ],
)
def test_expected_arrays_by_other_words(folder: Path, index: int, field: str, value: Any, word: str) -> None:
    def change(document: Any) -> None:
        document["expected"][index][field] = value

    edit(folder, change)
    if field == "png":
        manifest = json.loads((folder / "manifest.json").read_text())
        del manifest["arrays"]["expected/color.png"]
        (folder / "manifest.json").write_text(json.dumps(manifest))
    refused(folder, word, "case.json")


def test_a_final_image_of_another_size(folder: Path) -> None:
    array = np.zeros((3, 3))
    with (folder / "expected" / "depth.npy").open("wb") as file:
        write_array(file, array)
    edit(folder, put("expected", 1, "shape", value=[3, 3]))
    edit(folder, put("arrays", "expected/depth.npy", value=digest(array)), "manifest.json")
    refused(folder, "depth.shape", "the size of the camera")


def test_maps_of_another_scene(folder: Path, full_case: Case) -> None:
    if full_case.method != "shadows":
        return
    edit(folder, put("scene", "maps", "source", value="0" * 64))
    refused(folder, "case.json: maps: found 'those of another caster", "maps of this scene")
