"""Tiled TIFF files, written band by band."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tifffile

from ibr_ref import io
from ibr_ref.io import posters


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize(("height", "width"), [(1, 1), (256, 256), (300, 517), (600, 40)])
def test_a_poster_is_the_picture(tmp_path: Path, height: int, width: int, bits: int) -> None:
    picture = np.random.RandomState(0).uniform(-0.1, 1.1, (height, width, 3))
    asked: list[tuple[int, int]] = []

    def draw(rows: tuple[int, int]) -> np.ndarray:
        asked.append(rows)
        return picture[slice(*rows)]

    io.write_poster(tmp_path / "p.tif", draw, width, height, bits)
    assert asked == [(first, min(height, first + 256)) for first in range(0, height, 256)]
    with tifffile.TiffFile(tmp_path / "p.tif") as file:
        page = file.pages.first
        assert page.is_tiled
        assert file.is_bigtiff
        stored = page.asarray()
    levels = 2**bits - 1
    assert stored.dtype == (np.uint8 if bits == 8 else np.uint16)
    assert np.array_equal(stored, np.floor(np.clip(picture, 0, 1) * levels + 0.5))
    io.write_image(tmp_path / "i.tif", picture, bits)
    assert (tmp_path / "i.tif").read_bytes() == (tmp_path / "p.tif").read_bytes()
    assert np.array_equal(io.read_values(tmp_path / "p.tif"), stored)


def test_very_wide_pictures_have_lower_bands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(posters, "_MOST_PIXELS", 40 * 700)
    said: list[tuple[str, int, int]] = []
    picture = np.random.RandomState(1).random_sample((100, 700, 3))
    io.write_poster(
        tmp_path / "p.tif", lambda rows: picture[slice(*rows)], 700, 100, progress=lambda *s: said.append(s)
    )
    assert [done for _, done, _ in said] == [32, 64, 96, 100]
    assert np.array_equal(tifffile.imread(tmp_path / "p.tif"), np.floor(picture * 255 + 0.5))


def test_what_goes_wrong_leaves_no_file(tmp_path: Path) -> None:
    for draw, words in (
        (lambda rows: np.zeros((3, 4, 3)), r"^rows 0 to 9: found an array \(3, 4, 3\), allowed: \(10, 20, 3\)"),
        (lambda rows: np.full((10, 20, 3), np.nan), "found NaN"),
        (lambda rows: 1 / 0, "division"),
    ):
        with pytest.raises((ValueError, ZeroDivisionError), match=words):
            io.write_poster(tmp_path / "p.tif", draw, 20, 10)
        assert list(tmp_path.iterdir()) == []
    with pytest.raises(OSError, match="does not exist"):
        io.write_poster(tmp_path / "nowhere" / "p.tif", lambda rows: np.zeros((10, 20, 3)), 20, 10)
    with pytest.raises(ValueError, match=r"found an image of shape \(4, 5\), allowed in TIFF"):
        io.write_image(tmp_path / "grey.tif", np.zeros((4, 5)))
