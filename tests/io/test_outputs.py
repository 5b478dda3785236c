"""Where outputs go: links are followed, pipes and devices written to, everything else whole or not at all."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ibr_ref import Camera, DepthImage, io
from ibr_ref.io.outputs import atomic, check_writable, is_stream, make_folder
from tests.io.test_images import check_refused

FRAME = io.Frame(color=np.full((4, 5, 3), 0.4), depth=np.ones((4, 5)), stages={"a.b": np.arange(20).reshape(4, 5)})
IMAGE = DepthImage(
    color=FRAME.color,
    depth=np.full((4, 5), 2.0),
    camera=Camera.look_at(eye=(0, -3, 0), target=(0, 0, 0), width=5, height=4),
)

WRITERS: dict[str, tuple[str, Callable[[Path], None]]] = {
    "write_image": (".png", lambda path: io.write_image(path, FRAME.color)),
    "write_image, jpeg": (".jpg", lambda path: io.write_image(path, FRAME.color)),
    "write_image, exr": (".exr", lambda path: io.write_image(path, FRAME.color)),
    "write_image, 16 bits": (".png", lambda path: io.write_image(path, FRAME.color, bits=16)),
    "frame.save": (".png", FRAME.save),
    "frame.save_stages": (".npz", FRAME.save_stages),
    "write_simple_texture": (".xmt", lambda path: io.write_simple_texture(path, [IMAGE])),
}


@pytest.fixture(params=WRITERS)
def writer(request: pytest.FixtureRequest) -> tuple[str, Callable[[Path], None]]:
    return WRITERS[request.param]


def plain(folder: Path, writer: tuple[str, Callable[[Path], None]]) -> bytes:
    """What is written to a plain file of the same name."""
    (folder / "plain").mkdir()
    path = folder / "plain" / f"name{writer[0]}"
    writer[1](path)
    return path.read_bytes()


class Reader(threading.Thread):
    """Reads a pipe to its end."""

    def __init__(self, path: Path) -> None:
        super().__init__(daemon=True)
        self.path, self.data = path, b""
        self.start()

    def run(self) -> None:
        self.data = self.path.read_bytes()

    def all(self) -> bytes:
        self.join(20)
        assert not self.is_alive(), "the reader waits for ever"
        return self.data


def test_a_pipe(tmp_path: Path, writer: tuple[str, Callable[[Path], None]]) -> None:
    expected = plain(tmp_path, writer)
    path = tmp_path / f"name{writer[0]}"
    os.mkfifo(path)
    reader = Reader(path)
    writer[1](path)
    assert reader.all() == expected
    assert stat.S_ISFIFO(path.lstat().st_mode)


def test_a_link(tmp_path: Path, writer: tuple[str, Callable[[Path], None]]) -> None:
    """To a file, to a link, to nothing yet, with a path of its own; also to a pipe."""
    expected = plain(tmp_path, writer)
    path = tmp_path / f"name{writer[0]}"
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "old").write_bytes(b"old")
    (tmp_path / "link").symlink_to("deep/old")
    os.mkfifo(tmp_path / "pipe")
    for target in ("deep/old", tmp_path / "deep" / "old", "deep/new", "link", "pipe"):
        path.symlink_to(target)
        reader = Reader(tmp_path / "pipe") if target == "pipe" else None
        writer[1](path)
        assert path.is_symlink()
        assert os.readlink(path) == str(target)
        assert (reader.all() if reader else path.read_bytes()) == expected
        path.unlink()
    assert (tmp_path / "link").is_symlink()
    assert sorted(p.name for p in (tmp_path / "deep").iterdir()) == ["new", "old"], "nothing temporary is left"


def test_a_linked_folder(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to("folder")
    io.write_image(tmp_path / "link" / "a.png", [[0.5]])
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "folder" / "a.png").exists()
    (tmp_path / "made").symlink_to("later/on")
    assert make_folder(tmp_path / "made" / "inside") == tmp_path / "made" / "inside"
    assert (tmp_path / "later" / "on" / "inside").is_dir()


@pytest.mark.parametrize("target", ["loop", "none/a", "folder"])
def test_links_that_lead_nowhere(tmp_path: Path, target: str) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "loop").symlink_to(target)
    for write in (check_writable, FRAME.save_stages):
        check_refused(write, tmp_path / "loop")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["folder", "loop"]


def test_a_character_device(tmp_path: Path, writer: tuple[str, Callable[[Path], None]]) -> None:
    """A pseudo-terminal's far end: bytes arrive, and the device stays one."""
    main, other = os.openpty()
    try:
        path = tmp_path / f"name{writer[0]}"
        path.symlink_to(os.ttyname(other))
        thread = threading.Thread(target=writer[1], args=(path,), daemon=True)
        thread.start()
        assert os.read(main, 1)
        while thread.is_alive():
            os.read(main, 1 << 16)
            thread.join(0.05)
        assert stat.S_ISCHR(os.stat(path).st_mode)
    finally:
        os.close(main)
        os.close(other)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root makes device nodes")
def test_a_device_node(tmp_path: Path, writer: tuple[str, Callable[[Path], None]]) -> None:
    """A copy of /dev/null, never the real one."""
    path = tmp_path / f"name{writer[0]}"
    try:
        os.mknod(path, 0o600 | stat.S_IFCHR, os.makedev(1, 3))
        path.open("wb").close()
    except OSError as error:
        pytest.skip(f"device nodes do not work here: {error}")
    writer[1](path)
    assert stat.S_ISCHR(path.lstat().st_mode)
    check_writable(path)


def test_a_picture_without_an_ending_goes_to_a_pipe_as_png(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    reader = Reader(tmp_path / "pipe")
    io.check_image_writable(tmp_path / "pipe")
    FRAME.save(tmp_path / "pipe")
    assert reader.all().startswith(b"\x89PNG")
    check_refused(io.check_image_writable, tmp_path / "file", "the ending ''")


def test_asking_does_not_open_a_pipe(tmp_path: Path) -> None:
    """Its reader would see the end."""
    os.mkfifo(tmp_path / "pipe.npz")
    reader = Reader(tmp_path / "pipe.npz")
    check_writable(tmp_path / "pipe.npz")
    assert reader.is_alive()
    assert is_stream(tmp_path / "pipe.npz")
    FRAME.save_stages(tmp_path / "pipe.npz")
    assert reader.all()[:2] == b"PK"


def test_a_block_that_fails_writes_nothing_to_a_pipe(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    reader = Reader(tmp_path / "pipe")
    with pytest.raises(RuntimeError), atomic(tmp_path / "pipe") as file:  # noqa: PT012 - the block is what fails
        file.write(b"half")
        raise RuntimeError
    with atomic(tmp_path / "pipe") as file:
        file.write(b"whole")
    assert reader.all() == b"whole"


def test_a_reader_that_has_gone(tmp_path: Path) -> None:
    code = "import sys, os; from ibr_ref.io.outputs import atomic\n"
    code += "r, w = os.pipe(); os.close(r)\n"
    code += "try:\n  with atomic(f'/dev/fd/{w}') as file: file.write(bytes(10**6))\n"
    code += "except OSError as error: print(error)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "cannot be written (Broken pipe)" in done.stdout


@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "link"])
def test_standard_output_that_is_a_file(tmp_path: Path, name: str) -> None:
    """What was printed before and what is printed after stay beside it."""
    (tmp_path / "link").symlink_to("/dev/stdout")
    code = "from ibr_ref.io.outputs import atomic, check_writable\n"
    code += f"print('before'); check_writable({name!r})\n"
    code += f"with atomic({name!r}) as file: file.write(b'between\\n')\n"
    code += "print('after')"
    with (tmp_path / "out").open("wb") as out:
        done = subprocess.run(
            [sys.executable, "-c", code], stdout=out, stderr=subprocess.PIPE, cwd=tmp_path, check=False
        )
    assert not done.stderr
    assert (tmp_path / "out").read_text() == "before\nbetween\nafter\n"


def test_what_cannot_be_written_to(tmp_path: Path) -> None:
    import socket

    with socket.socket(socket.AF_UNIX) as made:
        made.bind(str(tmp_path / "socket"))
        for write in (check_writable, FRAME.save_stages):
            check_refused(write, tmp_path / "socket", "is a socket")
    check_refused(check_writable, Path("/dev/fd/987"), "cannot be written (Bad file descriptor)")
    with pytest.raises(OSError, match=r"a\\x00b: cannot be written"):
        check_writable(tmp_path / "a\0b")


def test_names_that_are_as_long_as_they_may_be(tmp_path: Path) -> None:
    path = tmp_path / ("x" * 251 + ".npz")
    FRAME.save_stages(path)
    assert path.exists()


def test_a_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    for path in (tmp_path / "file", tmp_path / "file" / "inside", tmp_path / ("x" * 300), tmp_path / "a\0b"):
        with pytest.raises(OSError, match=r"cannot be made \(.*\), a folder is needed"):
            make_folder(path)
