"""Films: videos of pictures that are there already, through imageio and FFmpeg."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ibr_ref.io.extras import needed
from ibr_ref.io.images import read_image
from ibr_ref.io.outputs import atomic, check_writable
from ibr_ref.scene import checks
from ibr_ref.scene.checks import named

ENDINGS = (".mp4", ".mkv", ".webm", ".gif")

EXTRA = "video"


def check_film_writable(path: str | PathLike[str], width: int, height: int) -> None:
    """Raise what `write_film` would for this name and pictures of this size, before long work."""
    needed("imageio_ffmpeg", "videos", EXTRA)
    if Path(path).suffix.lower() not in ENDINGS:
        raise ValueError(f"{named(path)}: found the ending {Path(path).suffix!r}, allowed: {', '.join(ENDINGS)}")
    if width % 2 or height % 2:
        raise ValueError(f"{named(path)}: found pictures of {width} x {height} pixels, allowed in videos: even sides")
    check_writable(path)


def write_film(path: str | PathLike[str], pictures: Sequence[str | PathLike[str]], fps: float = 30.0) -> None:
    """Write picture files, one a frame, as a video: .mp4, .mkv, .webm or .gif. Needs ibr_ref[video].

    fps: frames a second, > 0 up to 1000. The file is whole or not there.
    """
    from imageio import v2

    rate = checks.number("fps", fps, above=0.0, high=1000.0)
    needed("imageio_ffmpeg", "videos", EXTRA)
    handle, name = tempfile.mkstemp(suffix=Path(path).suffix)  # FFmpeg goes back in what it writes
    os.close(handle)
    try:
        options: dict[str, Any] = {"fps": rate, "macro_block_size": 2}
        imageio: Any = v2  # its types do not know the writers
        with imageio.get_writer(name, format="FFMPEG", mode="I", **options) as film:
            for picture in pictures:
                film.append_data(_bytes(picture))
        with atomic(path) as file, open(name, "rb") as made:
            while part := made.read(1 << 20):
                file.write(part)
    finally:
        os.unlink(name)


def _bytes(picture: str | PathLike[str]) -> Any:
    image = np.floor(read_image(picture) * 255.0 + 0.5).astype(np.uint8)
    return image if image.ndim == 3 else image[..., None].repeat(3, axis=2)
