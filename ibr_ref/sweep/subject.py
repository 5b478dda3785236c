"""What is swept over, as it travels to the workers, and its digest: the same for the same scene, wherever it was made."""

from __future__ import annotations

import io
import pickle
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.scene.digests import digest_of


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
        return digest_of(self.method, tuple(self.views), self.against)


class _Pickler(pickle.Pickler):
    def reducer_override(self, value: Any) -> Any:
        return array_with_flags(value)


def array_with_flags(value: Any) -> Any:
    """For `reducer_override`: arrays with their flags, NotImplemented for all else."""
    if type(value) is np.ndarray and value.dtype.kind in "buif":
        return _array, (value.tobytes(), value.dtype.str, value.shape, value.flags.writeable)
    return NotImplemented


def _array(data: bytes, dtype: str, shape: tuple[int, ...], writeable: bool) -> NDArray[Any]:
    array = np.frombuffer(bytearray(data), dtype).reshape(shape)
    array.setflags(write=writeable)
    return array
