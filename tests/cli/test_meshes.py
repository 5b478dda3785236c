"""What the command line says of meshes that cannot be read."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import imageio.v3 as imageio
import numpy as np
import pytest

from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line
from tests.io import corpus

SMALL = ("--map-size", 64, "--rows", 5, "--columns", 4, "--size", "96x72")
ITEMS = {item.name: item for item in corpus.items()}
BAD = [
    "underscore.obj", "infinite.obj", "line.obj", "crossing-bowtie-huge.obj", "lost-vertex.stl", "count-4294967295.stl",
    "ascii-wrong-2.ply", "binary_big_endian-infinite.ply", "float-too-large.ply", "required-KHR_draco.glb",
    "node-overflowing.glb",
    "mode-lines-5123.glb", "long-name.gltf", "uri-0.gltf", "required-X_X_X_X_X.glb",
]  # fmt: skip
LONGEST = 400


def rendered(method: str, mesh: Path, out: Path) -> tuple[object, ...]:
    if method == "shadows":
        return ("render", "shadows", "--caster", mesh, *SMALL, "--out", out)
    return (
        "render",
        "splatting",
        "--mesh",
        mesh,
        "--count",
        4,
        "--reference-size",
        16,
        "--size",
        "32x24",
        "--out",
        out,
    )


@pytest.mark.parametrize("method", ["shadows", "splatting"])
@pytest.mark.parametrize("name", BAD)
def test_one_line_and_no_picture(run: Run, tmp_path: Path, method: str, name: str) -> None:
    item = ITEMS[name]
    assert item.refusal is not None
    mesh, out = item.written(tmp_path), tmp_path / "out.png"
    result = run(*rendered(method, mesh, out))
    assert_one_line(result, f"ibr-ref: {mesh}: ", item.refusal)
    assert len(result[2]) <= LONGEST + len(str(mesh))
    assert "http" not in result[2]
    assert result[1] == ""
    assert not out.exists()


@pytest.mark.parametrize("method", ["shadows", "splatting"])
def test_a_pipe_beside_a_mesh(tmp_path: Path, method: str) -> None:
    """In a process of its own: it would wait for ever, and say what NumPy warns of."""
    item = ITEMS["external.gltf"]
    mesh = item._replace(beside=()).written(tmp_path)
    os.mkfifo(tmp_path / "numbers.bin")
    code = "import sys; from ibr_ref.cli import main; main()"
    arguments = [str(a) for a in rendered(method, mesh, tmp_path / "out.png")]
    run = subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=120, check=False
    )
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr == f"ibr-ref: {mesh}: buffers.0.uri: 'numbers.bin' is a device or a pipe, a file is needed\n"


@pytest.mark.parametrize("method", ["shadows", "splatting"])
def test_vertices_of_no_triangle_change_no_picture(run: Run, tmp_path: Path, cube: Path, method: str) -> None:
    stray = tmp_path / "stray.obj"
    # Corners counted back from the last vertex: the strays stand before and behind all faces.
    corners = cube.read_text().split("f ")[0]
    faces = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"]
    counted_back = ["f " + " ".join(str(int(corner) - 9) for corner in face.split()) for face in faces]
    stray.write_text(f"v 1e308 -1e308 1e308\n{corners}" + "\n".join(counted_back) + "\nv 100 100 100\n")
    pictures = []
    for mesh in (cube, stray):
        out = tmp_path / f"{mesh.stem}.png"
        assert run(*rendered(method, mesh, out)) == (0, "", "")
        pictures.append(imageio.imread(out))
    np.testing.assert_array_equal(*pictures)
    assert len(np.unique(pictures[0].reshape(-1, 3), axis=0)) >= 2
