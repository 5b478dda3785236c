"""Ways in which a file can be bad."""

from __future__ import annotations

import io
import os
import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Ran:
    """What a pickle would run: the test fails if it exists afterwards."""

    count = 0

    def __reduce__(self) -> tuple[Any, ...]:
        return (_ran, ())


def _ran() -> None:
    Ran.count += 1


def npy(array: NDArray[Any], **options: Any) -> bytes:
    """A NumPy file's bytes."""
    file = io.BytesIO()
    np.lib.format.write_array(file, array, **options)
    return file.getvalue()


def header(descr: str, shape: str, order: str = "False") -> bytes:
    """A NumPy header alone, whatever it claims."""
    text = f"{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}".encode()
    text += b" " * (-(len(text) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text


@contextmanager
def spare(path: Path) -> Iterator[None]:
    """The file is as it was afterwards, whatever becomes of it."""
    data = path.read_bytes()
    yield
    if path.is_dir() and not path.is_symlink():
        path.rmdir()
    path.unlink(missing_ok=True)
    path.write_bytes(data)


def _rewritten(change: Callable[[bytes], bytes]) -> Callable[[Path], None]:
    return lambda path: _put(path, change(path.read_bytes()))


def _put(path: Path, data: bytes) -> None:
    path.write_bytes(data)


def _directory(path: Path) -> None:
    path.unlink()
    path.mkdir()


def _link_outside(path: Path) -> None:
    outside = path.parent.parent.parent / f"outside-{path.name}"
    path.rename(outside)
    path.symlink_to(outside)


def _pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def _objects() -> NDArray[Any]:
    array = np.empty(3, object)
    array[:] = [Ran(), 1, "x"]
    return array


FILES: dict[str, Callable[[Path], None]] = {
    "cut in half": _rewritten(lambda data: data[: len(data) // 2]),
    "cut by two bytes": _rewritten(lambda data: data[:-2]),
    "emptied": _rewritten(lambda data: b""),
    "a directory": _directory,
    "a pipe": _pipe,
    "deleted": Path.unlink,
    "a pickle": _rewritten(lambda data: pickle.dumps([Ran()])),
    "text": _rewritten(lambda data: b"not at all\n"),
    "a link that leads nowhere": lambda path: (path.unlink(), path.symlink_to(path.parent / "nowhere"))[1],
    "a link to itself": lambda path: (path.unlink(), path.symlink_to(path))[1],
}
"""For any file."""


def _sparse(path: Path) -> None:
    """A header of 10 GB, and a file that is as large, without a block on the disk."""
    path.write_bytes(header("<f8", "(1342177280,)"))
    os.truncate(path, path.stat().st_size + 8 * 1342177280)


ARRAYS: dict[str, Callable[[Path], None]] = {
    "an object array": lambda path: _put(path, npy(_objects(), allow_pickle=True)),
    "a header of 10 GB": lambda path: _put(path, header("<f8", "(1342177280,)") + b"12345678"),
    "a header of 10 GB and a file": _sparse,
    "a header that overflows": lambda path: _put(path, header("<f8", f"({2**62}, {2**62})")),
    "a header without an end": lambda path: _put(path, b"\x93NUMPY\x02\x00\xff\xff\xff\xff{"),
    "a header that calls": lambda path: _put(path, header("<f8", "(__import__('os').getpid(),)")),
    "a negative shape": lambda path: _put(path, header("<f8", "(-1,)")),
    "a nested header": lambda path: _put(path, header("<f8", "(" * 900 + ")" * 900)),
    "one number more": _rewritten(lambda data: data + b"12345678"),
    "words": lambda path: _put(path, npy(np.array(["a", "b"]))),
    "structures": lambda path: _put(path, npy(np.zeros(3, [("a", "f4"), ("b", "i4")]))),
    "complex numbers": lambda path: _put(path, npy(np.load(path).astype(complex))),
    "half floats": lambda path: _put(path, npy(np.load(path).astype("<f2"))),
    "another shape": lambda path: _put(path, npy(np.load(path)[..., None])),
    "one row less": lambda path: _put(path, npy(np.load(path)[1:])),
    "big-endian": lambda path: _put(path, npy(_big(np.load(path)))),
}
"""For .npy files."""


def _big(array: NDArray[Any]) -> NDArray[Any]:
    wide = array.astype(np.int32) if array.dtype.itemsize == 1 else array
    return wide.astype(wide.dtype.newbyteorder(">"))


def fortran(path: Path) -> bool:
    """The same numbers in Fortran order; False where that is C order too."""
    array = np.asfortranarray(np.load(path))
    if array.flags.c_contiguous:
        return False
    _put(path, npy(array))
    return True


def with_nan(path: Path) -> bool:
    """NaN everywhere; False where there are no floats."""
    array = np.load(path)
    if array.dtype.kind != "f" or not array.size or np.isnan(array).all():
        return False
    _put(path, npy(np.full_like(array, np.nan)))
    return True


def changed(path: Path) -> bool:
    """The last number is another one; False where there is none."""
    array = np.load(path)
    if not array.size:
        return False
    flat = array.reshape(-1)
    flat[-1] = not flat[-1] if array.dtype.kind == "b" else flat[-1] + 1 if np.isfinite(flat[-1]) else 0
    _put(path, npy(array))
    return True


def other_dtype(path: Path) -> bool:
    """Integers as floats, floats as integers: the same shape."""
    array = np.load(path)
    kind = np.int32 if array.dtype.kind == "f" else np.float32
    with np.errstate(invalid="ignore"):
        _put(path, npy(np.nan_to_num(array).astype(kind)))
    return True


MAYBE: dict[str, Callable[[Path], bool]] = {
    "Fortran order": fortran,
    "another dtype": other_dtype,
}
"""For .npy files to which it applies."""
