"""Camera paths: a JSON file of the cameras that a film goes by."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any

from ibr_ref.io.files import contents, naming
from ibr_ref.scene import Camera, checks

MOST_CAMERAS, MOST_FRAMES = 10_000, 1_000_000

_FIELDS = {"eye", "target", "up", "vertical_fov"}


def read_camera_path(
    path: str | PathLike[str], width: int, height: int, frames: int, vertical_fov: float = 45.0
) -> list[Camera]:
    """The cameras of so many frames, evenly in time, on the way from one camera of the file to the next.

    The file: `{"cameras": [{"eye": [3, -2, 1], "target": [0, 0, 0]}, ...], "closed": false}`, two cameras or more, each with
    eye and target, and if need be `up` (0, 0, 1 without) and `vertical_fov` in degrees (that of the argument without). The
    way between two is that of `Camera.between` and takes as long as any other. The first frame is the first camera and the
    last one the last; of a closed path there is a way back to the first, and the last frame lies before it. width, height:
    of the pictures, pixels.
    Raises OSError or ValueError, in one line that starts with the path.
    """
    total = checks.whole("frames", frames, low=2, high=MOST_FRAMES)
    data = contents(path)
    with naming(path):
        cameras, closed = _read(data, {"width": width, "height": height, "vertical_fov": vertical_fov})
        ways = list(zip(cameras, [*cameras[1:], cameras[0]] if closed else cameras[1:], strict=False))
        return [_at(ways, i * len(ways) / (total if closed else total - 1)) for i in range(total)]


def _at(ways: Sequence[tuple[Camera, Camera]], time: float) -> Camera:
    way = min(int(time), len(ways) - 1)
    return Camera.between(*ways[way], min(time - way, 1.0))


def _read(data: bytes, others: dict[str, Any]) -> tuple[list[Camera], bool]:
    try:
        document = json.loads(data)
    except ValueError:
        raise ValueError('found no JSON, allowed: {"cameras": [...]}') from None
    if not isinstance(document, dict) or not set(document) <= {"cameras", "closed"}:
        raise ValueError(f"found {checks.one_line(_names(document))}, allowed: cameras, closed")
    entries, closed = document.get("cameras"), document.get("closed", False)
    if not isinstance(closed, bool):
        raise checks.reject("closed", closed, "true | false")
    if not isinstance(entries, list) or not 2 <= len(entries) <= MOST_CAMERAS:
        found = len(entries) if isinstance(entries, list) else entries
        raise checks.reject("cameras", found, f"a list of 2 to {MOST_CAMERAS}")
    return [_camera(f"cameras[{i}]", entry, others) for i, entry in enumerate(entries)], closed


def _camera(name: str, entry: Any, others: dict[str, Any]) -> Camera:
    if not isinstance(entry, Mapping) or not {"eye", "target"} <= set(entry) <= _FIELDS:
        raise ValueError(
            f"{name}: found {checks.one_line(_names(entry))}, allowed: eye, target, and perhaps up, vertical_fov"
        )
    try:
        return Camera.look_at(**{**others, **entry})
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _names(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, Mapping) else type(value).__name__
