"""The inputs of ../shared/faults give what its README asks. Each kind of fault has tests of its own where it belongs."""

from __future__ import annotations

import os
import shutil
import threading
from pathlib import Path
from typing import Any

import imageio.v3 as imageio
import numpy as np
import pytest

from ibr_ref import io
from tests.cli.conftest import Run

FAULTS = Path(__file__).parents[2].parent / "shared" / "faults"

pytestmark = [
    pytest.mark.skipif(not FAULTS.is_dir(), reason="../shared/faults is not beside the repository"),
    pytest.mark.usefixtures("one_thread"),
]

SMALL = ("--size", "32x24")


@pytest.fixture
def height(tmp_path: Path) -> Path:
    rows, columns = np.mgrid[0:16, 0:24]
    imageio.imwrite(tmp_path / "h.png", np.where((abs(rows - 8) < 3) & (abs(columns - 12) < 4), 60000, 0).astype("u2"))
    return tmp_path / "h.png"


@pytest.fixture
def tetrahedron() -> Path:
    return FAULTS / "05-unreferenced-vertex-shrinks-caster" / "t.obj"


def colors(path: Path) -> int:
    return len(np.unique(imageio.imread(path).reshape(-1, 3), axis=0))


def triangles(path: Path) -> np.ndarray:
    """(T, 3, 3) corners."""
    mesh = io.read_mesh(path)
    return np.asarray(mesh.vertices)[np.asarray(mesh.triangles)]


def area(corners: np.ndarray) -> float:
    """Of triangles (T, 3, 3), seen from above and below."""
    a, b = (corners[:, 1] - corners[:, 0]), (corners[:, 2] - corners[:, 0])
    return float(np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2.0)


def test_00_a_flat_grid_is_wrong_in_warp(run: Run, tmp_path: Path) -> None:
    case = tmp_path / "case"
    assert run("export", "shadows-box", case)[0] == 0
    port = FAULTS / "00-check-traceback-flat-grid" / "port_small"
    code, out, err = run("check", case, port, "--device", "ieee32")
    assert code == 1
    assert "FAIL: shadows-box, first wrong in stage warp" in out
    assert "Traceback" not in out + err


def test_01_pipes_and_devices_are_written_to_and_links_followed(run: Run, height: Path, tmp_path: Path) -> None:
    pipe, link, target, device = (tmp_path / name for name in ("out.fifo", "link.npz", "target.npz", "null"))
    os.mkfifo(pipe)
    target.touch()
    link.symlink_to(target)
    outputs = [pipe, link]
    try:
        os.mknod(device, 0o600 | 0o020000, os.makedev(1, 3))  # a character device: a private /dev/null
        outputs.append(device)
    except OSError:  # not for everybody
        pass
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()))
    reader.start()
    for path in outputs:
        made = run("render", "displacement", "--height", height, *SMALL, "--out", tmp_path / "x.png", "--stages", path)
        assert made == (0, "", "")
    reader.join(10.0)
    assert pipe.is_fifo()
    assert read
    assert read[0][:2] == b"PK"
    assert link.is_symlink()
    assert target.read_bytes() == read[0]
    assert device not in outputs or device.is_char_device()


def test_02_colours_of_16_bits() -> None:
    mesh = io.read_mesh(FAULTS / "02-gltf-uint16-colours" / "u16ramp.gltf")
    assert (np.asarray(mesh.color) * 65535.0 == [[65535.0] * 3, [32768.0] * 3, [16384.0] * 3, [49152.0] * 3]).all()


@pytest.mark.parametrize("name", ["draco.gltf", "draco_and_tri.gltf"])
def test_03_required_extensions_are_refused_by_name(name: str) -> None:
    path = FAULTS / "03-gltf-required-extensions" / name
    with pytest.raises(ValueError, match="KHR_draco_mesh_compression") as refused:
        io.read_mesh(path)
    assert str(refused.value).startswith(str(path))
    assert "\n" not in str(refused.value)


def test_03_quantized_corners_are_read() -> None:
    assert area(triangles(FAULTS / "03-gltf-required-extensions" / "quantized.gltf")) == pytest.approx(1.0)


def test_05_an_unused_vertex_changes_nothing(run: Run, tetrahedron: Path, tmp_path: Path) -> None:
    found = []
    for caster in (tetrahedron, tetrahedron.with_name("stray.obj")):
        out = tmp_path / f"{caster.stem}.png"
        assert run("render", "shadows", "--caster", caster, "--map-size", "32", *SMALL, "--out", out)[0] == 0
        found.append(out.read_bytes())
    assert found[0] == found[1]


@pytest.mark.parametrize(
    ("name", "expected"),
    [("dart_ngon.obj", 1.0), ("arrow.obj", 0.5), ("concave.obj", 3.0), ("concave2.obj", 10.0), ("ngon6.ply", 3.0)],
)
def test_06_concave_polygons_have_their_own_area(name: str, expected: float) -> None:
    folder = FAULTS / "06-concave-polygon"
    assert area(triangles(folder / name)) == pytest.approx(expected)
    assert area(triangles(folder / "dart_tri.obj")) == pytest.approx(1.0)


def test_07_a_triangle_and_a_quad() -> None:
    corners = triangles(FAULTS / "07-binary-ply-tri-quad" / "le_mixed.ply")
    assert len(corners) == 3


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ("render splatting --mesh T --count 4 --cameras 99 --view 7 --near 2 --far 2.5", "--cameras"),
        ("render splatting --mesh T --count 4 --law 1,0,0,1 --shape ellipse", "--law"),
        ("render shadows --caster T --method traced --samples 9 --policy nearest --content depth --rows 200", "--samples"),
        ("render displacement --height H --method relief --interval volume --faces extended", "--interval"),
        ("render displacement --height H --max-steps 3", "--max-steps"),
    ],
)  # fmt: skip
def test_09_options_that_do_not_apply_are_refused_by_name(
    run: Run, height: Path, tetrahedron: Path, tmp_path: Path, arguments: str, named: str
) -> None:
    files: dict[str, Any] = {"T": tetrahedron, "H": height}
    code, _, err = run(*(files.get(word, word) for word in arguments.split()), "--out", tmp_path / "a.png")
    assert code == 2
    assert named in err
    assert not (tmp_path / "a.png").exists()


def test_09_maps_that_are_there_have_their_controls(run: Run, tetrahedron: Path, tmp_path: Path) -> None:
    shadow = ("render", "shadows", "--caster", tetrahedron, "--map-size", "32", *SMALL, "--maps", tmp_path / "maps.npz")
    assert run(*shadow, "--out", tmp_path / "a.png")[0] == 0
    code, _, err = run(*shadow, "--controls", "best", "--out", tmp_path / "b.png")
    assert code == 2
    assert "--controls" in err


def test_10_what_is_far_is_in_the_picture(run: Run, height: Path, tetrahedron: Path, tmp_path: Path) -> None:
    shape = ("render", "displacement", "--height", height)
    for view in (("--eye", "0,-125,95", "--fov", "0.5"), ("--eye", "0,-12.5,9.5", "--fov", "5")):
        assert run(*shape, *view, "--size", "64x48", "--out", tmp_path / "far.png")[0] == 0
        assert colors(tmp_path / "far.png") > 10
    shadows = ("render", "shadows", "--caster", tetrahedron, "--map-size", "64", "--size", "64x48")
    assert run(*shadows, "--eye", "14,-30,21", "--out", tmp_path / "far.png")[0] == 0
    assert colors(tmp_path / "far.png") > 1


@pytest.mark.parametrize("name", ["cut2.jpg", "cutp.jpg"])
def test_12_a_cut_picture_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match=r"truncat|cut|incomplete"):
        io.read_image(FAULTS / "12-jpeg-cut-silent" / name)


def test_14_a_pipe_beside_a_mesh_is_refused_at_once(tmp_path: Path) -> None:
    shutil.copy(FAULTS / "14-gltf-pipe-hangs" / "pipel.gltf", tmp_path)
    os.mkfifo(tmp_path / "pipe.bin")
    with pytest.raises((ValueError, OSError), match=r"pipe\.bin"):
        io.read_mesh(tmp_path / "pipel.gltf")
