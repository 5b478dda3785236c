"""How kernels are compiled: the only file that names Numba options.

Every kernel is strict IEEE float64 (no fast-math, no contraction), so that its bits equal those of plain Python, and
raises nothing: inside a parallel loop an exception would be lost, so that inputs are validated on the host.

A parallel loop's body calls one device function per item. It must not store into the fields of a tuple itself: Numba
(0.68) takes such stores for dead code and drops them without a word.

Environment, read once at import:

- ``IBR_REF_SERIAL=1`` compiles without threads. Bounds checks (``NUMBA_BOUNDSCHECK=1``) only mean something then.
- ``NUMBA_CACHE_DIR`` moves the folder of compiled kernels; otherwise the user's cache folder is used.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import llvmlite
import numba
from numba import prange
from numba.core import config, event

__all__ = ["LANES", "compilations", "device", "functions", "kernel", "prange"]

LANES = 32
"""Fragments in a wave: enough to hide the latency of gathers, few enough that the lanes' arrays stay in the L1 cache."""

SERIAL = os.environ.get("IBR_REF_SERIAL", "0") not in ("", "0")

functions: list[Any] = []
"""All compiled functions of the modules imported so far (what a progress bar counts against)."""

Function = TypeVar("Function", bound=Callable[..., Any])


def _digest() -> str:
    """Key of the disk cache: Numba's own key sees neither an edited callee in another file nor the bounds-check switch."""
    digest = hashlib.sha256()
    switches = [os.environ.get(name, "") for name in ("NUMBA_BOUNDSCHECK", "NUMBA_OPT", "NUMBA_DEBUGINFO")]
    digest.update(repr((numba.__version__, llvmlite.__version__, sys.version_info[:2], SERIAL, *switches)).encode())
    package = Path(__file__).parent
    for source in sorted(package.rglob("*.py")):
        digest.update(str(source.relative_to(package)).encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _user_cache() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")


def _cache_directory() -> str:
    """A writable folder for this very version of the sources; a temporary one where the user's cache is read-only."""
    root = Path(config.CACHE_DIR) if config.CACHE_DIR else _user_cache() / "ibr_ref"
    folder = root / _digest()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError:
        folder = Path(tempfile.mkdtemp(prefix="ibr_ref-"))
    return str(folder)


_CACHE_DIRECTORY = "" if config.DISABLE_JIT else _cache_directory()


def kernel(function: Function) -> Function:
    """Compile an entry point: `prange` loops run on all threads, and the machine code is kept on disk."""
    before = config.CACHE_DIR
    config.CACHE_DIR = _CACHE_DIRECTORY  # read while decorating; restored, because other packages read it too
    try:
        compiled = numba.njit(parallel=not SERIAL, error_model="numpy", fastmath=False, cache=True)(function)
    finally:
        config.CACHE_DIR = before
    functions.append(compiled)
    return compiled  # type: ignore[no-any-return]


def device(function: Function) -> Function:
    """Compile a function that only kernels call."""
    compiled = numba.njit(error_model="numpy", fastmath=False)(function)
    functions.append(compiled)
    return compiled  # type: ignore[no-any-return]


class _Listener(event.Listener):  # type: ignore[misc]
    def __init__(self, started: Callable[[str], None]) -> None:
        self.started = started

    def on_start(self, event: Any) -> None:
        self.started(event.data["dispatcher"].py_func.__name__)

    def on_end(self, event: Any) -> None:
        pass


@contextmanager
def compilations(started: Callable[[str], None]) -> Iterator[None]:
    """While inside, call `started(name)` for every function that has to be compiled (not for those found on disk)."""
    with event.install_listener("numba:compile", _Listener(started)):
        yield
