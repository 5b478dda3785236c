"""NumPy archives (.npz): members by name, each checked before it is unpacked."""

from __future__ import annotations

import math
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from ibr_ref.oracle.files.handed import Slot
from ibr_ref.oracle.files.npy import LONGEST_HEADER, decode_bytes
from ibr_ref.oracle.files.problem import UnusableError

MOST_MEMBERS = 1000


@contextmanager
def opened(path: Path, name: str) -> Iterator[zipfile.ZipFile]:
    """The archive. Raises UnusableError for what is none, or damaged where it is read."""
    try:
        with zipfile.ZipFile(path) as archive:
            if len(archive.infolist()) > MOST_MEMBERS:
                raise UnusableError(name, f"{len(archive.infolist())} members", f"at most {MOST_MEMBERS}")
            yield archive
    except UnusableError:
        raise
    except Exception:  # damaged archives break zipfile and zlib in any way
        raise UnusableError(name, "no whole archive", "a NumPy archive (.npz)") from None


def member(archive: zipfile.ZipFile, info: zipfile.ZipInfo, slot: Slot, file: str) -> NDArray[Any]:
    """One array; no more is unpacked than the largest that is allowed needs."""
    most = math.prod(max(slot.shapes)) * 8 + LONGEST_HEADER + 12
    if info.file_size > most:
        raise UnusableError(file, f"{info.file_size} bytes", f"at most {most}")
    with archive.open(info) as stream:
        data = stream.read(most + 1)
    if len(data) != info.file_size:
        raise UnusableError(file, f"{len(data)} bytes", f"{info.file_size}, as the archive says")
    return decode_bytes(data, slot.accept(file), file)
