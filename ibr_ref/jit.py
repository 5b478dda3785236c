"""How kernels are compiled: the only file that names Numba options.

Every kernel is strict IEEE float64 (no fast-math, no contraction), so that its bits equal those of plain Python, and
raises nothing: inside a parallel loop an exception would be lost, so that inputs are validated on the host. While one runs,
other threads of Python do too: those that answer a page, or end the program when somebody asks for it.

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
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

# GNU OpenMP, which Numba's threads may be, lets a thread that waits spin for milliseconds. Where others want the cores
# too, it keeps them from the very thread that it waits for. Read when that library is loaded: before any kernel runs.
os.environ.setdefault("GOMP_SPINCOUNT", "2000")

import llvmlite
import numba
from numba import prange
from numba.core import config as _config
from numba.core import event
from platformdirs import user_cache_path

from ibr_ref.linking import DeviceCompiler, KernelCompiler

__all__ = ["LANES", "compilations", "device", "functions", "inlined", "kernel", "prange", "routine", "threads"]

config: Any = _config  # its attributes are made at run time

LANES = 32
"""Fragments in a wave: enough to hide the latency of gathers, few enough that the lanes' arrays stay in the L1 cache."""

SERIAL = os.environ.get("IBR_REF_SERIAL", "0") not in ("", "0")

functions: list[Any] = []
"""All compiled functions of the modules imported so far (what a progress bar counts against)."""

njit: Any = numba.njit  # its stubs do not know all options

Function = TypeVar("Function", bound=Callable[..., Any])

PACKAGE = Path(__file__).parent


def _room(function: Callable[..., Any]) -> str:
    """The folder of the package that a function stands in, such as "pipeline"; "" for functions outside the package."""
    package, *names = function.__module__.split(".")
    return names[0] if package == PACKAGE.name and len(names) > 1 else ""


def _sources(room: str) -> list[Path]:
    """Every file that a kernel of this room can be made of: this one, the pipeline, and the room's own.

    Methods do not import each other (a contract in pyproject.toml); a kernel outside the package may use all of it.
    """
    folders = {PACKAGE / "pipeline", PACKAGE / room} if room else {PACKAGE}
    return sorted(
        {Path(__file__), PACKAGE / "linking.py", *(source for folder in folders for source in folder.rglob("*.py"))}
    )


def _digest(room: str) -> str:
    """Key of the disk cache: Numba's own key sees neither an edited callee in another file nor the bounds-check switch."""
    digest = hashlib.sha256()
    switches = [os.environ.get(name, "") for name in ("NUMBA_BOUNDSCHECK", "NUMBA_OPT", "NUMBA_DEBUGINFO")]
    digest.update(repr((numba.__version__, llvmlite.__version__, sys.version_info[:2], SERIAL, *switches)).encode())
    for source in _sources(room):
        digest.update(str(source.relative_to(PACKAGE)).encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


@cache
def _tell(line: str) -> None:
    """Say it on standard error, once."""
    print(line, file=sys.stderr)


@cache
def _cache_directory(room: str) -> str:
    """A writable folder for this very version of a room's sources; a temporary one where the user's cache is read-only."""
    root = Path(config.CACHE_DIR) if config.CACHE_DIR else user_cache_path("ibr_ref", appauthor=False)
    folder = root / _digest(room)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        found = f"kernels cannot be kept in {root} ({error.strerror}) and are compiled anew each time"
        _tell(f"ibr_ref: {found}; NUMBA_CACHE_DIR names another folder")
        folder = Path(tempfile.mkdtemp(prefix="ibr_ref-"))
    return str(folder)


def _entry(function: Function, parallel: bool) -> Function:
    before = config.CACHE_DIR
    # Read while decorating; restored, because other packages read it too.
    config.CACHE_DIR = "" if config.DISABLE_JIT else _cache_directory(_room(function))
    try:
        compiled = njit(
            parallel=parallel,
            error_model="numpy",
            fastmath=False,
            cache=True,
            nogil=True,
            no_cfunc_wrapper=True,
            pipeline_class=KernelCompiler,
        )(function)
    finally:
        config.CACHE_DIR = before
    functions.append(compiled)
    return cast(Function, compiled)


def kernel(function: Function) -> Function:
    """Compile an entry point whose `prange` loop runs on all threads; the machine code is kept on disk."""
    return _entry(function, parallel=not SERIAL)


def routine(function: Function) -> Function:
    """Compile an entry point that runs on one thread: what is too short, or too ordered, to be shared out."""
    return _entry(function, parallel=False)


def device(function: Function) -> Function:
    """Compile a function that compiled code calls.

    The wrappers that let Python call it would take a fifth of all compilation. Where Python does, as tests do, the call
    goes to another compilation that has them.
    """
    return _part(function)


def inlined(function: Function) -> Function:
    """The same for a function that its callers are to take in whole: one that loops over several arrays of lanes.

    As a call of its own it would not know that they do not overlap, and compare the ends of every two of them in each wave.
    """
    return _part(function, forceinline=True)


def _part(function: Function, **options: Any) -> Function:
    options |= {"error_model": "numpy", "fastmath": False}
    compiled = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, pipeline_class=DeviceCompiler, **options)(function)
    if not config.DISABLE_JIT:
        for_python = cache(lambda: njit(**options)(function))
        compiled._insert = lambda *overload, **options: None  # so that a call from Python finds nothing compiled ...
        compiled._compile_for_args = lambda *arguments, **options: for_python()  # ... and gets this instead
    functions.append(compiled)
    return cast(Function, compiled)


class _Listener(event.Listener):
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


def threads() -> int:
    """Threads that a `prange` loop runs on."""
    return 1 if SERIAL or config.DISABLE_JIT else int(numba.get_num_threads())
