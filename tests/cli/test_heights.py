"""`ibr-ref render displacement` of heights of any file: the same picture, whatever holds them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ibr_ref import io
from ibr_ref.cli.base_polygon import greys
from ibr_ref.io import exr, pfm
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line
from tests.io import tiff_writer

SHARE = np.round(np.add.outer(np.sin(np.arange(12)) + 1, np.cos(np.arange(16)) + 1) * 60) / 256
"""Exact in every format."""
PROJECTED = [(34735, "H", [1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, 9001]), (33550, "d", [40.0, 40.0, 0.0])]


def drawn(run: Run, folder: Path, name: str, data: bytes, *options: object) -> np.ndarray:
    (folder / name).write_bytes(data)
    out = folder / "out.png"
    assert run("render", "displacement", "--height", folder / name, "--size", "40x30", "--out", out, *options) == (
        0,
        "",
        "",
    )
    return io.read_image(out)


def test_the_same_heights_in_any_file(run: Run, tmp_path: Path) -> None:
    metres, floats = 100.0 + 512.0 * SHARE, SHARE.astype(np.float32)
    first = drawn(run, tmp_path, "a.pfm", pfm.encode(floats))
    assert len(np.unique(first)) > 9
    raw = ("--height-size", "16x12", "--height-order", "big", "--height-range", "100,612")
    for name, data, options in [
        ("a.exr", exr.encode(floats), ()),
        ("a.tif", tiff_writer.encode(floats, tile=16, deflate=True), ()),
        ("b.tif", tiff_writer.encode(metres.astype(np.int16)), ("--height-range", "100,612")),
        ("c.tif", tiff_writer.encode((SHARE * 256).astype(np.uint8)), ("--height-range", "0,256")),
        ("a.raw", metres.astype(">u2").tobytes(), raw),
        ("a", metres.astype(">f4").tobytes(), (*raw, "--height-format", "raw")),
    ]:
        np.testing.assert_array_equal(drawn(run, tmp_path, name, data, *options), first)


def test_true_proportions(run: Run, tmp_path: Path) -> None:
    """512 m of relief over 16 texels of 40 m are 0.8 of the map's longer side."""
    metres, floats = (100.0 + 512.0 * SHARE).astype(np.float32), SHARE.astype(np.float32)
    first = drawn(run, tmp_path, "a.pfm", pfm.encode(floats), "--height-scale", "0.8")
    ranged = ("--height-range", "100,612")
    own = drawn(run, tmp_path, "own.tif", tiff_writer.encode(metres, tags=PROJECTED), *ranged)
    np.testing.assert_array_equal(own, first)
    plain = tiff_writer.encode(metres)
    for options in (("--texel-size", "40"), ("--texel-size", "80,80", "--height-scale", "1024")):
        np.testing.assert_array_equal(drawn(run, tmp_path, "a.tif", plain, *ranged, *options), first)
    wide = drawn(run, tmp_path, "a.tif", plain, *ranged, "--texel-size", "40,20")
    assert (wide != first).any()


def test_colours_of_an_exr_file(run: Run, tmp_path: Path) -> None:
    colors = np.stack([SHARE, 1 - SHARE, SHARE * 0 + 0.5], axis=2)
    io.write_image(tmp_path / "c.png", np.round(colors * 255) / 255)
    (tmp_path / "c.exr").write_bytes(exr.encode(io.read_image(tmp_path / "c.png")))
    heights = pfm.encode(SHARE)
    first = drawn(run, tmp_path, "a.pfm", heights, "--color", tmp_path / "c.png")
    np.testing.assert_array_equal(drawn(run, tmp_path, "a.pfm", heights, "--color", tmp_path / "c.exr"), first)


@pytest.mark.parametrize(
    ("name", "data", "options", "words"),
    [
        ("a.tif", tiff_writer.encode(100 + SHARE), (), ("found heights from 100.", "192 of 192", "--height-range")),
        ("a.r16", bytes(384), (), ("found 384 bytes of raw samples and no size", "--height-size")),
        (
            "a.tif",
            tiff_writer.encode(SHARE),
            ("--height-size", "16x12"),
            ("found a size for a file that says its own",),
        ),
        ("a.tif", tiff_writer.encode(SHARE), ("--height-range", "1,0"), ("height_range: found [1.0, 0.0]",)),
        (
            "a.tif",
            tiff_writer.encode(SHARE),
            ("--height-range", "1"),
            ("--height-range", "found '1', allowed: 2 numbers"),
        ),
        ("a.tif", tiff_writer.encode(SHARE), ("--texel-size", "0"), ("texel_size: found [0.0, 0.0]",)),
        ("a.tif", tiff_writer.encode(SHARE), ("--texel-size", "1,2,3"), ("found '1,2,3', allowed: 2 numbers",)),
        (
            "a.tif",
            tiff_writer.encode(SHARE),
            ("--nodata", str(SHARE[0, 0])),
            ("without a height", "row 0, column 0", "--fill"),
        ),
        ("a.tif", tiff_writer.encode(SHARE), ("--height-format", "bmp"), ("--height-format",)),
    ],
)
def test_what_is_refused(
    run: Run, tmp_path: Path, name: str, data: bytes, options: tuple[str, ...], words: tuple[str, ...]
) -> None:
    (tmp_path / name).write_bytes(data)
    out = tmp_path / "out.png"
    assert_one_line(run("render", "displacement", "--height", tmp_path / name, "--out", out, *options), *words)
    assert not out.exists()


def test_colours_made_of_heights_stay_small() -> None:
    """Each texel's own; and of a large map those in the middle of where they lie."""
    small = np.linspace(0, 1, 12).reshape(3, 4)
    np.testing.assert_array_equal(greys(small)[..., 2], 0.25 + 0.65 * small)
    large = np.broadcast_to(np.arange(6144)[:, None] / 6144, (6144, 2))
    np.testing.assert_allclose(greys(large)[:, 0, 0], 0.25 + 0.65 * (3 * np.arange(2048) + 1) / 6144, rtol=1e-15)
