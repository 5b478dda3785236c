"""Depth sets of every format with one file changed by chance: each is read, or refused in one line.

    python -m tests.io.fuzz_depth_sets --count 5000

prints how many were read and refused, and each input that was neither: `--only K` reads that one again, `--seed` others.
"""

from __future__ import annotations

import random
import sys
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from ibr_ref import io
from tests.io import exr_writer
from tests.io.depth_sets import shots, writers
from tests.io.depth_sets.test_formats import OWN, npy, pair
from tests.io.fuzz_meshes import changed
from tests.io.fuzzing import LONGEST_MESSAGE, TooLong, clock, limits, run

OUTCOMES = ("read", "refused", "traceback", "undocumented", "hang", "memory", "message")
K = {"intrinsics": writers.tum_intrinsics(shots.K)}


def exr(path, shot):
    path.write_bytes(exr_writer.encode({"Z": shot.depth.astype(np.float32)}))


SETS = {
    "open3d": (writers.open3d, {}),
    "tum": (writers.tum, K),
    "scannet": (writers.scannet, {}),
    "transforms": (writers.transforms, {}),
    "colmap": (writers.colmap, {}),
    "colmap-text": (lambda folder, seen: writers.colmap(folder, seen, binary=False, model="OPENCV"), {}),
    "middlebury": (lambda folder, seen: writers.middlebury(folder, pair(), 0.3), {}),
    "folder": (lambda folder, seen: writers.own(folder, seen, npy, "npy"), OWN),
    "folder-together": (lambda folder, seen: writers.own(folder, seen, exr, "exr", together=True), OWN),
}


def written(folder: Path) -> dict[str, tuple[Path, list[Path]]]:
    """Each set's folder and files; those that say most about it are in it more often."""
    result = {}
    for name, (write, _) in SETS.items():
        place = folder / name
        place.mkdir()
        write(place, shots.shots(2))
        files = sorted(path for path in place.rglob("*") if path.is_file())
        result[name] = place, [path for path in files for _ in range(1 if path.suffix in (".png", ".exr") else 6)]
    return result


def change(path: Path, chance: random.Random) -> bytes:
    """The file's bytes after one to three changes; fields of a document are changed as such."""
    name = "a.gltf" if path.suffix == ".json" else path.name
    return changed(SimpleNamespace(name=name, data=path.read_bytes()), chance)


def outcome(name: str, folder: Path) -> tuple[str, str]:
    """What became of a set: read, refused, or what must not be, and how."""
    try:
        with clock():
            set_ = io.read_depth_set(folder, name.split("-")[0], **SETS[name][1])
            bad = [image for image in set_ if not np.isfinite(image.points).all()]
        return ("traceback", "points that are not finite") if bad else ("read", "")
    except TooLong:
        return "hang", ""
    except (OSError, ValueError) as error:
        return _message(str(error), str(folder))
    except Exception as error:
        return "traceback", f"{type(error).__name__} {error}"


def _message(text: str, folder: str) -> tuple[str, str]:
    said = text.removeprefix(folder)
    if "does not fit in memory" in said:
        return "memory", said
    if "found what cannot be decoded" in said or said == text:
        return "undocumented", text
    if len(said) > 2 * LONGEST_MESSAGE or "\n" in said or "http" in said:
        return "message", said
    return "refused", said


def tally(folder: Path, count: int, seed: int, only: int | None = None) -> Counter[str]:
    """Outcomes of so many inputs; all that must not be is printed."""
    sets, found = written(folder), Counter[str]()
    with limits():
        for k in range(count) if only is None else [only]:
            chance = random.Random(f"{seed} {k}")
            name = chance.choice(list(sets))
            place, files = sets[name]
            path = chance.choice(files)
            data = path.read_bytes()
            path.write_bytes(change(path, chance))
            kind, words = outcome(name, place)
            path.write_bytes(data)
            found[kind] += 1
            if kind not in ("read", "refused") or only is not None:
                print(f"{k} ({path.relative_to(folder)}): {kind} {words[:300]}")
    return found


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:], __doc__, tally, OUTCOMES))
