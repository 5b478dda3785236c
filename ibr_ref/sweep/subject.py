"""What is swept over, as it travels to the workers, and its digest: the same for the same scene, wherever it was made."""

from __future__ import annotations

import hashlib
import io
import pickle
from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

PACKAGE = Path(__file__).parents[1]


@dataclass(frozen=True)
class Subject:
    """A method's scene from all views, and what it is measured against."""

    method: str
    views: Sequence[Any]
    """Scenes of the method."""
    against: str

    def packed(self) -> bytes:
        """What `unpacked` takes: arrays come out read-only where they were, as kernels are compiled for either kind."""
        file = io.BytesIO()
        _Pickler(file, protocol=5).dump((self.method, tuple(self.views), self.against))
        return file.getvalue()

    @classmethod
    def unpacked(cls, packed: bytes) -> Subject:
        """A subject from another process."""
        return cls(*pickle.loads(packed))

    @property
    def digest(self) -> str:
        """SHA-256 of all that rows depend on beside their setting, the package's sources with it."""
        found = hashlib.sha256(sources_digest().encode())
        _add(found, (self.method, tuple(self.views), self.against))
        return found.hexdigest()


def sources_digest() -> str:
    """SHA-256 of the package's sources, by which workers that have another version are told."""
    found = hashlib.sha256()
    for source in sorted(PACKAGE.rglob("*.py")):
        found.update(source.relative_to(PACKAGE).as_posix().encode() + source.read_bytes())
    return found.hexdigest()


class _Pickler(pickle.Pickler):
    def reducer_override(self, value: Any) -> Any:
        """Arrays with their flags."""
        if type(value) is np.ndarray and value.dtype.kind in "buif":
            return _array, (value.tobytes(), value.dtype.str, value.shape, value.flags.writeable)
        return NotImplemented


def _array(data: bytes, dtype: str, shape: tuple[int, ...], writeable: bool) -> NDArray[Any]:
    array = np.frombuffer(bytearray(data), dtype).reshape(shape)
    array.setflags(write=writeable)
    return array


def _add(digest: Any, value: Any) -> None:
    """Add what a description says: fields of dataclasses, elements of sequences, numbers, words, arrays."""
    if is_dataclass(value) and not isinstance(value, type):
        digest.update(f"{type(value).__qualname__}(".encode())
        for field in fields(value):
            digest.update(f"{field.name}=".encode())
            _add(digest, getattr(value, field.name))
    elif isinstance(value, np.ndarray):
        digest.update(f"{value.dtype.str}{value.shape}".encode() + value.tobytes())
    elif isinstance(value, (tuple, list)):
        digest.update(f"[{len(value)}]".encode())
        for each in value:
            _add(digest, each)
    else:
        digest.update(f"{type(value).__qualname__} {value!r};".encode())
