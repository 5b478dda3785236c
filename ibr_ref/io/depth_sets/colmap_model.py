"""The cameras and images of a COLMAP model, from its text or its binary files. What is in neither is not read: points."""

from __future__ import annotations

import struct
from io import BytesIO
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ibr_ref.io.depth_sets.text import finite, lines, text
from ibr_ref.io.files import contents, naming
from ibr_ref.io.words import shown, whole
from ibr_ref.scene import checks


class CameraModel(NamedTuple):
    """How many parameters a model has, how many of them are a pinhole's, and whether it bends even if the others are 0."""

    name: str
    parameters: int
    pinhole: int
    bends: bool = False


CAMERA_MODELS = (
    CameraModel("SIMPLE_PINHOLE", 3, 3),
    CameraModel("PINHOLE", 4, 4),
    CameraModel("SIMPLE_RADIAL", 4, 3),
    CameraModel("RADIAL", 5, 3),
    CameraModel("OPENCV", 8, 4),
    CameraModel("OPENCV_FISHEYE", 8, 4, bends=True),
    CameraModel("FULL_OPENCV", 12, 4),
    CameraModel("FOV", 5, 4, bends=True),
    CameraModel("SIMPLE_RADIAL_FISHEYE", 4, 3, bends=True),
    CameraModel("RADIAL_FISHEYE", 5, 3, bends=True),
    CameraModel("THIN_PRISM_FISHEYE", 12, 4, bends=True),
    CameraModel("RAD_TAN_THIN_PRISM_FISHEYE", 16, 4, bends=True),
)
"""By number, as COLMAP has them (src/colmap/sensor/models.h)."""
_NAMES = {model.name: i for i, model in enumerate(CAMERA_MODELS)}
_MOST_TEXT = 2**30
"""Bytes of images.txt: it also has every feature."""
_MOST_NAME = 4096


class ColmapCamera(NamedTuple):
    """Of a model."""

    model: int
    size: tuple[int, int]
    parameters: list[float]


class ColmapImage(NamedTuple):
    """Of a model: world to camera."""

    name: str
    camera: int
    quaternion: list[float]
    """w, x, y, z."""
    translation: list[float]


def read_model(folder: Path) -> tuple[dict[int, ColmapCamera], list[ColmapImage]]:
    """Cameras by number, and images in the order of their names."""
    ending = ".bin" if (folder / "cameras.bin").exists() else ".txt"
    read_cameras, read_images = (_cameras_bin, _images_bin) if ending == ".bin" else (_cameras_txt, _images_txt)
    path = folder / f"cameras{ending}"
    with naming(path):
        cameras = read_cameras(path)
    path = folder / f"images{ending}"
    with naming(path):
        images = read_images(path)
    return cameras, sorted(images, key=lambda image: image.name)


def _camera(model: int, width: int, height: int, parameters: list[float]) -> ColmapCamera:
    size = checks.whole("width", width, low=1, high=65536), checks.whole("height", height, low=1, high=65536)
    if not np.isfinite(parameters).all():
        raise checks.reject("parameters", parameters, "finite numbers")
    return ColmapCamera(model, size, parameters)


def _cameras_txt(path: Path) -> dict[int, ColmapCamera]:
    """`CAMERA_ID MODEL WIDTH HEIGHT PARAMS...` a line."""
    result = {}
    for number, words in lines(path):
        try:
            key, width, height = (whole(words[i]) for i in (0, 2, 3))
            model = _NAMES[words[1].decode("latin-1")]
        except (ValueError, IndexError, KeyError):
            allowed = f"a number, {' | '.join(_NAMES)}, width, height and parameters"
            raise ValueError(f"line {number}: found {shown(words)}, allowed: {allowed}") from None
        parameters = finite(words[4:], CAMERA_MODELS[model].parameters, f"line {number}: parameters")
        result[key] = _camera(model, width, height, parameters)
    return result


def _images_txt(path: Path) -> list[ColmapImage]:
    """`IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME` and then a line, perhaps empty, of features."""
    result = []
    rest = iter(enumerate(BytesIO(text(path, _MOST_TEXT)), 1))
    for number, line in rest:
        words = line.split(None, 9)
        if not words or words[0].startswith(b"#"):
            continue
        if len(words) != 10:
            raise ValueError(f"line {number}: found {shown(words)}, allowed: ten words, IMAGE_ID to NAME")
        values = finite(words[1:8], 7, f"line {number}")
        try:
            camera = whole(words[8])
        except ValueError:
            raise ValueError(f"line {number}: found {shown(words[8:9])}, allowed: a camera's number") from None
        name = words[9].rstrip().decode("utf-8", "replace")
        result.append(ColmapImage(name, camera, values[:4], values[4:]))
        next(rest, None)
    return result


class _Bytes:
    """Numbers read one after another, little-endian, as far as there are some."""

    def __init__(self, data: bytes) -> None:
        self._data, self.place = data, 0

    def take(self, form: str) -> tuple[int | float, ...]:
        size = struct.calcsize("<" + form)
        if self.place + size > len(self._data):
            raise ValueError(f"found a truncated file of {len(self._data)} bytes, allowed: {self.place + size} or more")
        self.place += size
        return struct.unpack_from("<" + form, self._data, self.place - size)

    def skip(self, size: int) -> None:
        if self.place + size > len(self._data):
            raise ValueError(f"found a truncated file of {len(self._data)} bytes, {self.place + size} needed")
        self.place += size

    def word(self) -> str:
        """Up to a zero byte."""
        end = self._data.find(b"\0", self.place, self.place + _MOST_NAME)
        if end < 0:
            raise ValueError(f"found a name without an end at byte {self.place}, allowed: up to {_MOST_NAME} bytes")
        start, self.place = self.place, end + 1
        return self._data[start:end].decode("utf-8", "replace")

    def check_end(self) -> None:
        if self.place != len(self._data):
            raise ValueError(f"found {len(self._data) - self.place} bytes after the last one, allowed: none")


def _cameras_bin(path: Path) -> dict[int, ColmapCamera]:
    data, result = _Bytes(contents(path)), {}
    (count,) = data.take("Q")
    for _ in range(int(count)):
        key, model, width, height = (int(value) for value in data.take("IiQQ"))
        model = checks.whole("camera model", model, low=0, high=len(CAMERA_MODELS) - 1)
        parameters = [float(value) for value in data.take(f"{CAMERA_MODELS[model].parameters}d")]
        result[key] = _camera(model, width, height, parameters)
    data.check_end()
    return result


def _images_bin(path: Path) -> list[ColmapImage]:
    data, result = _Bytes(contents(path)), []
    (count,) = data.take("Q")
    for _ in range(int(count)):
        _, *numbers, camera = data.take("I7dI")
        values = [float(value) for value in numbers]
        name = data.word()
        if not np.isfinite(values).all():
            raise ValueError(f"image {checks.one_line(name)}: found {values}, allowed: finite numbers")
        (features,) = data.take("Q")
        data.skip(24 * int(features))  # x, y and the point's number
        result.append(ColmapImage(name, int(camera), values[:4], values[4:]))
    data.check_end()
    return result
