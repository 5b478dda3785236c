"""Golden frames: a few scenes of every method, and the digests of all that is rendered from them.

`python -m tests.golden` compares with data/golden.json; `--write` makes that file anew, which is right only after a change
of a method or of the built-in models that was meant. `--size 48x36` prints the digests of other sizes. Scenes are named
method/scene; `tests/<method>/golden_scenes.py` has those of a method: functions of the picture's width and height that give
what its `render` takes.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core import config
from numpy.typing import NDArray

from ibr_ref import jit, methods
from ibr_ref.io import Frame
from tests.agreement import flat

GOLDEN = Path(__file__).parents[1] / "data" / "golden.json"
WIDTH, HEIGHT = 160, 120

METHODS: dict[str, Any] = {name: import_module(f"tests.{name}.golden_scenes") for name in methods.names()}
"""Modules with SCENES, TINY (the names of those that can do without compiled kernels) and `render`."""

SCENES: dict[str, Callable[[int, int], tuple[Any, ...]]] = {
    f"{method}/{name}": scene for method, module in METHODS.items() for name, scene in module.SCENES.items()
}
TINY = tuple(f"{method}/{name}" for method, module in METHODS.items() for name in module.TINY)

Digests = dict[str, str]
"""SHA-256 by the name of the array."""


def rendered(name: str, width: int = WIDTH, height: int = HEIGHT) -> Frame:
    """A scene with all its stages."""
    frame: Frame = METHODS[name.split("/")[0]].render(*SCENES[name](width, height))
    return frame


def digest(array: NDArray[np.generic]) -> str:
    """SHA-256 of type, shape and values: little-endian, C order; -0.0 counts as 0.0, and every NaN as the same one."""
    if array.dtype.kind == "f":
        array = np.where(np.isnan(array), np.nan, array + 0.0)
    little = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
    return hashlib.sha256(f"{little.dtype.str} {little.shape} ".encode() + little.tobytes()).hexdigest()


def digests(frame: Frame) -> Digests:
    """The digests of a frame's picture, its depth and its stages; a stage of several arrays as name.0, name.1, ..."""
    arrays = {"color": frame.color, "depth": frame.depth, **flat(frame.stages)}
    return {name: digest(array) for name, array in arrays.items()}


def changed(now: Digests, before: Digests) -> list[str]:
    """The names of the arrays that differ, in the order of the stages."""
    return [name for name in {**now, **before} if now.get(name) != before.get(name)]


def golden() -> dict[str, Digests]:
    """The digests that are kept, by the name of the scene."""
    kept = json.loads(GOLDEN.read_text())
    return {f"{method}/{name}": arrays for method, scenes in kept.items() for name, arrays in scenes.items()}


def write(now: dict[str, Digests]) -> None:
    """Keep these digests: method by method, in the order of `SCENES`."""
    kept: dict[str, dict[str, Digests]] = {method: {} for method in METHODS}
    for scene in SCENES:
        if scene in now:
            method, name = scene.split("/")
            kept[method][name] = now[scene]
    GOLDEN.write_text(json.dumps(kept, indent=1) + "\n")


def circumstances() -> dict[str, Any]:
    """How the kernels were compiled and run."""
    return {
        "threads": numba.get_num_threads(),
        "serial": jit.SERIAL,
        "bounds checked": bool(config.BOUNDSCHECK),
        "processor": config.CPU_NAME,
        "compiled": not config.DISABLE_JIT,
    }


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.golden", description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="scene", help=f"only these, of: {', '.join(SCENES)}")
    parser.add_argument("--write", action="store_true", help=f"write {GOLDEN}")
    parser.add_argument("--size", metavar="WxH", help="print the digests of pictures of this size, as JSON")
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    options = parse(arguments)
    size = [int(side) for side in options.size.split("x")] if options.size else [WIDTH, HEIGHT]
    now = {name: digests(rendered(name, *size)) for name in options.scenes or SCENES}
    if options.size:
        print(json.dumps({"circumstances": circumstances(), "digests": now}))
        return 0
    if options.write:
        write({**(golden() if options.scenes else {}), **now})
        return 0
    before = golden()
    different = {name: changed(now[name], before.get(name, {})) for name in now}
    for name, arrays in different.items():
        print(f"{name}: {', '.join(arrays) or 'unchanged'}")
    return int(any(different.values()))


if __name__ == "__main__":
    sys.exit(main())
