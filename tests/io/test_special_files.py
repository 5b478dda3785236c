"""A mesh, or numbers beside it, that is no file: refused at once, where a plain reader would wait for ever."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from ibr_ref import io
from tests.io.corpus.gltf_files import plain
from tests.io.test_images import check_refused

READ = "import sys\nfrom ibr_ref import io\ntry: io.read_mesh(sys.argv[1])\nexcept ValueError as error: print(error)"


def refused(path):
    """The message of a process of its own, which would be ended if it waited."""
    run = subprocess.run(
        [sys.executable, "-c", READ, str(path)], capture_output=True, text=True, timeout=60, check=True
    )
    assert run.stderr == ""
    return run.stdout.removeprefix(f"{path}: ")


def document(folder, uri):
    path = folder / "a.gltf"
    path.write_bytes(plain().gltf(uri))
    return path


def test_a_pipe_beside_a_gltf(tmp_path):
    os.mkfifo(tmp_path / "pipe.bin")
    assert (
        refused(document(tmp_path, "pipe.bin")) == "buffers.0.uri: 'pipe.bin' is a device or a pipe, a file is needed\n"
    )
    os.symlink("pipe.bin", tmp_path / "link.bin")
    assert "is a device or a pipe" in refused(document(tmp_path, "link.bin"))
    assert "is a device or a pipe" in refused(document(tmp_path, "p%69pe.bin"))


@pytest.mark.parametrize("target", ["/dev/zero", "/dev/tty", "/dev/stdin"])
def test_a_device_beside_a_gltf(tmp_path, target):
    os.symlink(target, tmp_path / "link.bin")
    check_refused(io.read_mesh, document(tmp_path, "link.bin"), "buffers.0.uri: 'link.bin'")
    check_refused(io.read_mesh, document(tmp_path, target), "buffers.0.uri", "a file in the folder")


def test_a_folder_and_an_empty_file_beside_a_gltf(tmp_path):
    (tmp_path / "folder").mkdir()
    check_refused(io.read_mesh, document(tmp_path, "folder"), "buffers.0.uri: 'folder' is a folder")
    check_refused(io.read_mesh, document(tmp_path, "."), "buffers.0.uri: '.' is a folder")
    (tmp_path / "empty").touch()
    check_refused(io.read_mesh, document(tmp_path, "empty"), "buffers.0.uri: 'empty' found 0 bytes")


def test_a_link_beside_a_gltf_is_followed(tmp_path):
    (tmp_path / "numbers").write_bytes(plain().data)
    os.symlink("numbers", tmp_path / "link.bin")
    assert io.read_mesh(document(tmp_path, "link.bin")).triangles.shape == (4, 3)


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "glb", "gltf", "bpt"])
def test_the_mesh_itself_is_a_pipe(tmp_path, ending):
    path = tmp_path / f"pipe.{ending}"
    os.mkfifo(path)
    check_refused(io.read_mesh, path, "is a device or a pipe")


def test_buffers_that_no_mesh_needs_are_not_read(tmp_path):
    made = plain()
    data = made.data
    made.tree["images"] = [{"bufferView": len(made.tree["bufferViews"])}]
    made.tree["bufferViews"].append({"buffer": 1, "byteLength": 8})
    made.gltf("numbers.bin")
    made.tree["buffers"].append({"uri": "no-such-picture.bin", "byteLength": 8})
    (tmp_path / "numbers.bin").write_bytes(data)
    import json

    (tmp_path / "a.gltf").write_text(json.dumps(made.tree))
    assert io.read_mesh(tmp_path / "a.gltf").triangles.shape == (4, 3)
