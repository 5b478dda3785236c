"""What errors of readers say: one line of bounded length, in our words, and nothing beside it."""

from __future__ import annotations

import io as streams
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref import io, shadows
from ibr_ref.io.files import naming
from ibr_ref.scene import checks
from ibr_ref.scene.checks import LONGEST_MESSAGE, LONGEST_NAME, named, one_line

LONG = "a" * 80_000


def refusal(call: Callable[[], Any]) -> str:
    """What is said: of bounded length, printable, without an address or a library's words."""
    with pytest.raises((OSError, ValueError)) as caught:
        call()
    message = str(caught.value)
    assert len(message) <= LONGEST_NAME + LONGEST_MESSAGE + 100
    assert message.isprintable()
    assert not re.search(
        r"https?:|pickle|zlib|numpy|pydantic|Traceback|PIL|\bErrno\b|convert string|digits", message
    ), message
    return message


def npz(folder: Path, **arrays: Any) -> Path:
    np.savez(folder / "a.npz", **arrays)
    return folder / "a.npz"


def maps(**changed: Any) -> dict[str, Any]:
    grid = np.stack(np.meshgrid(np.linspace(0, 1, 3), np.linspace(0, 1, 3)), axis=-1)
    x, y = np.meshgrid([0.0, 1.0, 2.0], [0.0, 1.0, 2.0])
    whole = {
        "positions": np.stack([x, y], axis=-1),
        "texels": np.zeros((3, 3, 8, 8), np.uint8),
        "controls": np.broadcast_to(grid, (3, 3, 3, 3, 2)),
        "content": np.array("mask"),
        "samples": np.array(1),
        "source": np.array("0" * 64),
    }
    return {**whole, **changed}


def test_whole_maps_are_read(tmp_path: Path) -> None:
    assert shadows.Maps.load(npz(tmp_path, **maps())).size == 8


@pytest.mark.parametrize(
    "changed",
    [
        {"content": np.array(LONG)},
        {"positions": np.array([None], object)},
        {"texels": np.array([{}], object)},
        {"controls": np.array(["a" * 500] * 100)},
        {"samples": np.array(LONG)},
        {"samples": np.array([1, 2])},
        {"positions": np.full((3, 3, 2), 1e308)},
        {"positions": np.zeros((3, 3, 2), complex)},
        {"controls": np.full((3, 3, 2, 2, 2), 1e300)},
        {"texels": np.zeros((2**10, 2**10), np.uint8)},
        {"texels": np.zeros((), np.uint8)},
        {"controls": np.zeros(())},
    ],
)
def test_maps_that_are_none(tmp_path: Path, changed: dict[str, Any]) -> None:
    path = npz(tmp_path, **maps(**changed))
    assert refusal(lambda: shadows.Maps.load(path)).startswith(f"{path}: ")


def damaged_archives(whole: bytes) -> dict[str, bytes]:
    stream = streams.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name in maps():
            archive.writestr(f"{name}.npy", LONG)
    return {
        "empty": b"PK",
        "text": LONG.encode(),
        "cut": whole[: len(whole) // 2],
        "flipped": whole[:200] + bytes(200) + whole[400:],
        "no arrays": stream.getvalue(),
    }


@pytest.mark.parametrize("way", ["empty", "text", "cut", "flipped", "no arrays"])
def test_archives_that_are_none(tmp_path: Path, way: str) -> None:
    path = npz(tmp_path, **maps())
    path.write_bytes(damaged_archives(path.read_bytes())[way])
    message = refusal(lambda: shadows.Maps.load(path))
    assert message.startswith(f"{path}: ")


READERS: dict[str, Callable[[Path], Any]] = {
    "read_image": io.read_image,
    "read_height": io.read_height,
    "read_color": io.read_color,
    "read_normal": io.read_normal,
    "read_normal_height": io.read_normal_height,
    "read_msr": io.read_msr,
    "read_simple_texture": io.read_simple_texture,
    "Maps.load": shadows.Maps.load,
}


@pytest.mark.parametrize("name", READERS)
@pytest.mark.parametrize(
    "path",
    [LONG, f"/{LONG}/{LONG}", "a\nb", "a\x1b[31mb", "a\0b", "a\udcffb", "", "\n", " "],
    ids=lambda p: repr(p)[:12],
)
def test_names_of_any_kind(name: str, path: str) -> None:
    refusal(lambda: READERS[name](Path(path)))
    refusal(lambda: READERS[name](path))


@pytest.mark.parametrize("name", READERS)
@pytest.mark.parametrize(
    "data", [LONG.encode(), b"\x89PNG\r\n\x1a\n" + bytes(5000), b"\xff\xd8\xff" + bytes(5000), b"PK" * 4000]
)
def test_files_of_any_kind(tmp_path: Path, name: str, data: bytes) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(data)
    assert refusal(lambda: READERS[name](path)).startswith(f"{path}: ")


@pytest.mark.parametrize(
    "words",
    [
        LONG,
        "0 " + LONG,
        " ".join(["0"] + ["1e308"] * 23),
        " ".join(["9" * 5000] * 24),
        "0 " + "1e-320 " * 9 + "0 0 " + "1e308 " * 12,
    ],
    ids=lambda words: words[:12],
)
def test_calibrations(tmp_path: Path, words: str) -> None:
    """Also numbers that overflow in what follows: one refusal, no warning (which would be an error here)."""
    (tmp_path / "calibParams-ballet.txt").write_text(words)
    io.write_image(tmp_path / "depth-cam0-f000.png", np.full((4, 4), 0.5))
    io.write_image(tmp_path / "color-cam0-f000.jpg", np.full((4, 4, 3), 0.5))
    refusal(lambda: io.read_msr(tmp_path, cameras=[0]))


@pytest.mark.parametrize("field", ["position", "orientation", "fieldOfView", "nearPlane", "orthographic", "unknown"])
@pytest.mark.parametrize("value", [LONG, "1e308 1e308 1e308 1e308", "9" * 5000, "1e-320 1e-320"], ids=lambda v: v[:8])
def test_fields_of_a_simple_texture(tmp_path: Path, field: str, value: str) -> None:
    text = f'<XMT-A xmlns="urn:mpeg:mpeg4:xmta:schema:2002"><DepthImage {field}="{value}"/></XMT-A>'
    (tmp_path / "a.xmt").write_text(text)
    refusal(lambda: io.read_simple_texture(tmp_path / "a.xmt"))


@pytest.mark.parametrize(
    "error",
    [
        ValueError("Cannot load file containing pickled data when allow_pickle=False"),
        OSError(LONG),
        RuntimeError("see https://example.org/errors"),
        KeyError("x"),
        SyntaxError("broken PNG file"),
        ValueError(f"could not convert string to float: {LONG!r}"),
        RecursionError(LONG),
        AssertionError(),
    ],
    ids=lambda error: type(error).__name__,
)
def test_words_of_libraries_are_replaced(error: Exception) -> None:
    with (
        pytest.raises(ValueError, match=r"^a\.bin: found what cannot be decoded, allowed: ") as caught,
        naming("a.bin"),
    ):
        raise error
    assert len(str(caught.value)) < 120


def test_our_own_words_are_kept() -> None:
    for words in (
        "x: found 1, allowed: 2",
        "found 5 bytes, 6 needed",
        "b.bin: is a device or a pipe, a file is needed",
    ):
        with pytest.raises(ValueError, match=f"^a: {words}$"), naming("a"):
            raise ValueError(words)


def test_no_warning_gets_out_of_a_decoder() -> None:
    """Warnings are errors in this test run, and would come out as such."""
    with pytest.raises(ValueError, match="found inf, allowed: finite"), naming("a"):
        raise checks.reject("x", float(np.float64(1e308) * 10), "finite")


def test_lines_are_bounded() -> None:
    assert one_line("a\n b\t c") == "a b c"
    assert one_line(LONG) == "a" * 97 + " ... " + "a" * 97
    assert one_line("\x1b[31m\x00é") == "\\x1b[31m\\x00é"
    assert named(Path("a  b") / "c") == "a  b/c"
    assert str(checks.reject("n", 10**5000, "less")) == "n: found a int that cannot be shown, allowed: less"


COMMANDS: list[list[str]] = [
    ["render", "displacement", "--height", "H", "--out", "o.png", "--eye", LONG],
    ["render", "displacement", "--height", "H", "--out", "o.png", "--eye", "1e200,0,0"],
    ["render", "displacement", "--height", "H", "--out", "o.png", "--eye", "1e308,1e308,1e308"],
    ["render", "displacement", "--height", "H", "--out", "o.png", "--height-scale", "1e308"],
    [
        "render",
        "displacement",
        "--height",
        "H",
        "--out",
        "o.png",
        "--light",
        "1e300,1e300,1e300",
        "--target",
        "1e300,0,0",
    ],
    ["render", "displacement", "--height", "H", "--out", "o.png", "--size", "9" * 5000 + "x1"],
    ["render", "displacement", "--height", "H", "--out", "o.png", "--fov", "9" * 5000],
    ["render", "displacement", "--height", "H", "--out", "o.png", "--steps", "9" * 5000],
    ["render", "displacement", "--height", "H", "--out", "o.png", "--method", LONG],
    ["render", "displacement", "--height", LONG, "--out", "o.png"],
    ["render", "displacement", "--height", "H", "--out", LONG],
    ["render", "displacement", "--height", "H", "--out", LONG + ".png"],
    ["render", "displacement", "--height", "H", "--out", "o.png", "--stages", LONG],
    ["render", "splatting", "--msr", LONG, "--view", "0", "--out", "o.png"],
    ["render", "splatting", "--msr", ".", "--view", "1:" + "9" * 5000, "--out", "o.png"],
    ["render", "splatting", "--msr", ".", "--view", "0", "--cameras", "9" * 5000, "--out", "o.png"],
    ["render", "shadows", "--caster", LONG, "--out", "o.png"],
    ["render", "shadows", "--offset", "1e300,1e300", "--out", "o.png"],
    ["render", "shadows", "--eye", "1e200,1e200,1e200", "--out", "o.png"],
    ["export", LONG, "x"],
    ["export", "displacement-box", LONG],
    ["check", LONG, LONG],
    ["check", "--self-test", "--method", LONG],
    ["bench", LONG],
    ["reproduce", LONG],
    ["reproduce", "1", "--out", LONG],
    [LONG],
    ["--" + LONG],
]


@pytest.mark.sampled(4)
@pytest.mark.parametrize("words", COMMANDS, ids=lambda words: " ".join(word[:12] for word in words))
def test_options_of_any_length(tmp_path: Path, words: list[str]) -> None:
    """In a process of its own, where a warning would be printed beside the line."""
    (tmp_path / "H").write_bytes(_height())
    code = "import sys; from ibr_ref import cli; sys.argv = ['ibr-ref', *sys.stdin.read().split('\\0')]; cli.main()"
    done = subprocess.run(
        [sys.executable, "-c", code], input="\0".join(words), cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2, done.stderr
    assert done.stderr.startswith("ibr-ref: ")
    assert done.stderr.count("\n") == 1, done.stderr
    assert len(done.stderr) <= LONGEST_MESSAGE + 20
    assert "http" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["H"], "nothing is left behind"


def _height() -> bytes:
    stream = streams.BytesIO()
    from PIL import Image

    Image.new("L", (4, 4), 100).save(stream, "PNG")
    return stream.getvalue()
