"""What all parts of `case.json` share: strict models, numbers as tuples, and arrays that lie in files beside it."""

from __future__ import annotations

from dataclasses import fields
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field

from ibr_ref.scene import checks

Vector2 = tuple[float, float]
Vector3 = tuple[float, float, float]
Vector4 = tuple[float, float, float, float]
Matrix2x3 = tuple[Vector3, Vector3]
Matrix3 = tuple[Vector3, Vector3, Vector3]
Matrix4 = tuple[Vector4, Vector4, Vector4, Vector4]
"""Row by row; matrices multiply column vectors and are named destination_from_source."""

FileName = Annotated[str, Field(pattern=r"^(inputs|expected)/[A-Za-z0-9][A-Za-z0-9._-]{0,99}$")]
"""A file of the case's folder: of its two subfolders, with a plain name. No other place can be written down."""

DType = Literal["bool", "uint8", "int32", "float64"]

MOST_SIDE = 2**31 - 1


class Model(BaseModel):
    """Unknown fields, other types, NaN and infinities are refused."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", strict=True, allow_inf_nan=False, use_attribute_docstrings=True
    )


def values(model: type[Model], params: Any) -> dict[str, Any]:
    """The fields of a method's Params that its model has.

    The others belong to systems that are compared with, of which there are no cases: raises ValueError where one has
    another value than its default.
    """
    own = {field.name: field for field in fields(params)}
    for name, field in own.items():
        if name not in model.model_fields and getattr(params, name) != field.default:
            raise checks.reject(name, getattr(params, name), f"{field.default!r} in a case for ports")
    return {name: getattr(params, name) for name in own if name in model.model_fields}


class StoredFile(Model):
    """An array in a file."""

    file: FileName
    """A NumPy file (.npy, version 1): little-endian, C order."""
    png: FileName | None = None
    """The same as an 8-bit PNG, where it is one to the last bit (booleans: 0 and 255); of the final colour the bytes
    floor(255 c + 0.5)."""
    dtype: DType
    shape: tuple[Annotated[int, Field(ge=0, le=MOST_SIDE)], ...]
    """Images: (rows, columns[, channels]), row 0 on top."""
    meaning: str


class ArrayFile(StoredFile):
    """An array that the port is given."""

    values: Literal["as stored", "k / 255"]
    """"k / 255": the file has bytes k and the texel is k / 255, as a UNORM texture gives it."""


def numbers(value: ArrayLike) -> Any:
    """An array of floats as nested tuples."""
    return _tuples(np.asarray(value, np.float64).tolist())


def _tuples(value: Any) -> Any:
    return tuple(_tuples(item) for item in value) if isinstance(value, list) else value


class Inputs:
    """The arrays of a case as files, collected while it is described."""

    def __init__(self) -> None:
        self.arrays: dict[str, NDArray[Any]] = {}
        """By the name of the .npy file."""
        self.images: dict[str, NDArray[np.uint8]] = {}
        """By the name of the .png file."""

    def array(self, stem: str, array: NDArray[Any], meaning: str) -> ArrayFile:
        """Numbers as they are; stem: the file's name without folder and ending."""
        return self._add(stem, np.asarray(array), "as stored", meaning, None)

    def codes(self, stem: str, codes: NDArray[np.uint8], meaning: str) -> ArrayFile:
        """Bytes (H, W, 3) that are no colours."""
        return self._add(stem, codes, "as stored", meaning, codes)

    def mask(self, stem: str, mask: NDArray[np.bool_], meaning: str) -> ArrayFile:
        """True and false (H, W)."""
        return self._add(stem, mask, "as stored", meaning, mask.astype(np.uint8) * np.uint8(255))

    def texture(self, stem: str, texels: ArrayLike, meaning: str) -> ArrayFile:
        """Texels in [0, 1], (H, W) or (H, W, 3): bytes where all of them are k / 255, to the last bit."""
        values = np.asarray(texels, np.float64)
        codes = np.rint(255.0 * values).astype(np.uint8)
        if (codes / 255.0 == values).all():
            return self._add(stem, codes, "k / 255", meaning, codes)
        return self._add(stem, values, "as stored", meaning, None)

    def _add(
        self,
        stem: str,
        array: NDArray[Any],
        values: Literal["as stored", "k / 255"],
        meaning: str,
        image: NDArray[np.uint8] | None,
    ) -> ArrayFile:
        file, png = f"inputs/{stem}.npy", None if image is None else f"inputs/{stem}.png"
        self.arrays[file] = array
        if png is not None and image is not None:
            self.images[png] = image
        dtype: Any = array.dtype.name
        return ArrayFile(file=file, png=png, dtype=dtype, shape=array.shape, values=values, meaning=meaning)


Stored = dict[str, NDArray[Any]]
"""Arrays by the name of their file, as they were read."""


def texels(stored: Stored, file: ArrayFile) -> NDArray[Any]:
    """The values that a file stands for."""
    array = stored[file.file]
    return array / 255.0 if file.values == "k / 255" else array
