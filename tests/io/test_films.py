"""Videos."""

from __future__ import annotations

from pathlib import Path

import imageio.v3 as imageio
import numpy as np
import pytest

from ibr_ref import io

pytest.importorskip("imageio_ffmpeg")


def pictures(folder: Path, count: int = 6) -> list[Path]:
    """A grey that grows lighter, but for a red corner."""
    files = []
    for i in range(count):
        color = np.full((48, 64, 3), i / (count - 1))
        color[:16, :16] = (1.0, 0.0, 0.0)
        io.write_image(folder / f"{i}.png", color)
        files.append(folder / f"{i}.png")
    return files


# imageio leaves the pipes that it reads from to the garbage collector.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_film_has_its_pictures_in_order(tmp_path: Path) -> None:
    io.write_film(tmp_path / "film.mp4", pictures(tmp_path), fps=12)
    frames = np.stack(list(imageio.imiter(tmp_path / "film.mp4", plugin="FFMPEG")))
    assert frames.shape == (6, 48, 64, 3)
    assert imageio.immeta(tmp_path / "film.mp4", plugin="FFMPEG")["fps"] == 12
    greys = frames[:, 30:, 30:].mean(axis=(1, 2, 3))
    assert np.abs(greys - 255 * np.arange(6) / 5).max() < 12
    assert (frames[:, 4:12, 4:12, 0].mean(axis=(1, 2)) > 200).all()


def test_films_that_cannot_be(tmp_path: Path) -> None:
    for name, size, words in (
        ("film.avi2", (64, 48), "film.avi2: found the ending '.avi2', allowed: .mp4"),
        ("film.mp4", (63, 48), "film.mp4: found pictures of 63 x 48 pixels, allowed in videos: even sides"),
    ):
        with pytest.raises(ValueError, match=words):
            io.check_film_writable(tmp_path / name, *size)
    with pytest.raises(OSError, match="does not exist"):
        io.check_film_writable(tmp_path / "nowhere" / "film.mp4", 64, 48)
    with pytest.raises(ValueError, match="fps: found 0"):
        io.write_film(tmp_path / "film.mp4", pictures(tmp_path), fps=0)
    assert not (tmp_path / "film.mp4").exists()
