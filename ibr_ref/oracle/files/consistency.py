"""Whether a case's document says the same everywhere: whatever follows from something else in it is compared with it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.files.problem import UnusableError
from ibr_ref.oracle.schema import Document
from ibr_ref.oracle.schema.base import StoredFile
from ibr_ref.oracle.schema.camera import CameraFile, build_camera, contradiction
from ibr_ref.oracle.schema.stages import StageFile, describe_stage

_WORDS = {"meaning", "nothing"}
"""Fields of an expected array that are for people: another version may word them otherwise."""


def check_cameras(where: str, part: Any) -> None:
    """Raise UnusableError for the first camera whose near, far or eye is not that of its matrices, to rounding."""
    for path, camera in _cameras(where, part):
        try:
            found = contradiction(build_camera(camera))
        except ValueError as error:
            raise ValueError(f"{path}.{error}") from None
        if found is not None:
            raise UnusableError(f"{path}.{found[0]}", *found[1:])


def _cameras(where: str, part: Any) -> Iterator[tuple[str, CameraFile]]:
    if isinstance(part, CameraFile):
        yield where, part
    elif isinstance(part, BaseModel):
        for name in type(part).model_fields:
            yield from _cameras(f"{where}.{name}", getattr(part, name))
    elif isinstance(part, tuple):
        for i, item in enumerate(part):
            yield from _cameras(f"{where}[{i}]", item)


def check_expected(where: str, document: Document) -> None:
    """Raise UnusableError for expected arrays that are no such: unknown, twice, without a picture, of another size."""
    named: dict[str, StageFile] = {}
    for i, stage in enumerate(document.expected):
        field = f"{where}expected[{i}]"
        if stage.name in named:
            raise UnusableError(f"{field}.name", repr(stage.name), "each name once")
        named[stage.name] = stage
        try:
            known = describe_stage(document.method, stage.name, np.broadcast_to(np.empty((), stage.dtype), stage.shape))
        except (KeyError, ValueError):
            raise UnusableError(f"{field}.name", repr(stage.name), f"the arrays of {document.method}") from None
        check_same(field, _without_words(stage), _without_words(known))
    camera = document.scene.camera
    for name, shape in (("color", (camera.height, camera.width, 3)), ("depth", (camera.height, camera.width))):
        if name not in named:
            raise UnusableError(f"{where}expected", f"no {name}", "color and depth, and stages")
        if named[name].shape != shape:
            raise UnusableError(f"{where}expected: {name}.shape", named[name].shape, f"{shape}, the size of the camera")


def _without_words(stage: StageFile) -> dict[str, Any]:
    return {name: value for name, value in stage if name not in _WORDS}


def check_picture(where: Path, file: StoredFile, array: NDArray[Any], picture: NDArray[np.uint8]) -> None:
    """Raise UnusableError for a PNG that is not the array beside it in 8 bits."""
    codes = array * np.uint8(255) if array.dtype == bool else array if array.dtype == np.uint8 else color_bytes(array)
    different = np.argwhere(picture != codes)
    if len(different):
        index = tuple(different[0].tolist())
        raise UnusableError(where, f"{picture[index]} at {list(index)}", f"{codes[index]}, as in {file.file}")


def check_arrays(folder: Path, made: Mapping[str, str], listed: Mapping[str, str]) -> None:
    """Raise UnusableError for an input that comes out otherwise when it is written anew; hashes by file."""
    for name, digest in made.items():
        if listed.get(name) != digest:
            raise UnusableError(folder / name, "numbers that the case does not keep as they are", "those that it uses")


def check_same(where: str, found: Any, allowed: Any) -> None:
    """Raise UnusableError for the first part of a document that differs from what the rest of it says."""
    if isinstance(found, BaseModel) and type(found) is type(allowed):
        found, allowed = dict(found), dict(allowed)
    if isinstance(found, dict) and isinstance(allowed, dict) and found.keys() == allowed.keys():
        for name in found:
            check_same(f"{where}{'' if where.endswith(' ') else '.'}{name}", found[name], allowed[name])
    elif isinstance(found, tuple) and isinstance(allowed, tuple) and len(found) == len(allowed):
        for i, pair in enumerate(zip(found, allowed, strict=True)):
            check_same(f"{where}[{i}]", *pair)
    elif found != allowed:
        raise UnusableError(where, found, f"{allowed}, which the rest of the case makes of it")
