"""Height files made by formula, changed by chance: each is read as heights in [0, 1], or refused in one line.

    python -m tests.io.fuzz_heights --count 5000

prints how many were read and refused, and each input that was neither: `--only K` reads that one again, `--seed` others.
"""

from __future__ import annotations

import random
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ibr_ref import io
from ibr_ref.io import exr, pfm
from tests.io import exr_writer, png_writer, tiff_writer
from tests.io.fuzzing import LONGEST_MESSAGE, TooLong, clock, limits, run

OUTCOMES = ("read", "refused", "no heights", "traceback", "hang", "message")
_WORDS = [0, 1, 2, 3, 7, 8, 16, 255, 256, 32767, 32768, 65535, 2**31 - 1, 2**31, 2**32 - 1]


@dataclass(frozen=True)
class Item:
    """A file, and how it is read."""

    name: str
    data: bytes
    options: dict[str, Any] = field(default_factory=dict)


def items() -> list[Item]:
    """One of each kind, all of the same slopes."""
    unit = np.add.outer(np.arange(23), np.arange(31)).astype(np.float32) / 52.0
    metres = (400.0 + 100.0 * unit).astype(np.float32)
    void = metres.copy()
    void[3, 4:9] = -9999.0
    projected = [(33550, "d", [30.0, 30.0, 0.0]), (34735, "H", [1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, 9001])]
    gdal = [
        (42113, "s", b"-9999\0"),
        (42112, "s", b'<GDALMetadata><Item name="SCALE" sample="0" role="scale">2</Item>'),
    ]
    within = {"height_range": (300.0, 1300.0), "fill": 400.0}
    stored = np.round((metres.astype(float) + 32768.0) * 256.0).astype(int)
    tile = np.stack([stored >> 16, stored >> 8 & 255, stored & 255], axis=2).astype(np.uint8)
    return [
        Item("strips.tif", tiff_writer.encode(unit)),
        Item("tiles.tif", tiff_writer.encode(unit, tile=16, deflate=True, order=">")),
        Item("bytes.tif", tiff_writer.encode((unit * 255).astype(np.uint8), white_is_zero=True)),
        Item("sparse.tif", tiff_writer.encode(void, tile=16, sparse=(1,), tags=[*projected, *gdal]), within),
        Item("signed.tif", tiff_writer.encode(metres.astype(np.int16), order=">", tags=gdal), within),
        Item("scan.exr", exr_writer.encode({"Y": unit})),
        Item("zip.exr", exr_writer.encode({"anything": unit.astype(np.float16)}, zipped=True)),
        Item("library.exr", exr.encode(np.repeat(unit[..., None], 3, axis=2))),
        Item("one.pfm", pfm.encode(unit)),
        Item("three.pfm", pfm.encode(np.repeat(unit[..., None], 3, axis=2))),
        Item("short.r16", (unit * 65535).astype("<u2").tobytes(), {"size": (31, 23)}),
        Item("float.raw", metres.astype(">f4").tobytes(), {"size": (31, 23), "order": "big", **within}),
        Item("tile.png", png_writer.encode(tile, 8), {"kind": "terrarium", **within}),
        Item("grey.png", png_writer.encode((unit * 65535).astype(np.uint16), 16)),
    ]


def changed(data: bytes, chance: random.Random) -> bytes:
    """The file's bytes after one to three changes."""
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        change: Callable[[bytes, random.Random], bytes] = chance.choice(
            (_bit, _bit, _word, _word, _word, _cut, _longer)
        )
        data = change(data, chance) if data else data
    return data


def _place(data: bytes, chance: random.Random) -> int:
    """Anywhere, or where headers are: at the start, and, of TIFF, at the end."""
    first, last = chance.choice(((0, len(data)), (0, 350), (len(data) - 400, len(data))))
    return chance.randrange(max(first, 0), min(last, len(data)))


def _bit(data: bytes, chance: random.Random) -> bytes:
    place = _place(data, chance)
    return data[:place] + bytes([data[place] ^ 1 << chance.randrange(8)]) + data[place + 1 :]


def _word(data: bytes, chance: random.Random) -> bytes:
    """A number of two or four bytes that headers do not expect."""
    place, size = _place(data, chance), chance.choice((2, 4))
    word = (chance.choice(_WORDS) & 2 ** (8 * size) - 1).to_bytes(size, chance.choice(("little", "big")))
    return data[:place] + word + data[place + size :]


def _cut(data: bytes, chance: random.Random) -> bytes:
    begin, end = sorted(_place(data, chance) for _ in range(2))
    return chance.choice((data[:end], data[:begin] + data[end:], data[:-1]))


def _longer(data: bytes, chance: random.Random) -> bytes:
    begin, end = sorted(_place(data, chance) for _ in range(2))
    return chance.choice((data[:end] + data[begin:], data + bytes(chance.randrange(1, 99))))


def outcome(path: Path, options: dict[str, Any]) -> tuple[str, str]:
    """What became of a file: read, refused, or what must not be, and how."""
    try:
        with clock():
            heights = io.read_height(path, **options)
    except TooLong:
        return "hang", ""
    except (OSError, ValueError) as error:
        said = str(error).removeprefix(f"{path}: ")
        ours = said != str(error) and "cannot be decoded" not in said and "does not fit" not in said
        return ("refused" if ours and len(said) <= LONGEST_MESSAGE and said.isprintable() else "message"), str(error)
    except Exception as error:
        return "traceback", f"{type(error).__name__} {error}"
    right = heights.ndim == 2 and heights.dtype == np.float64 and ((heights >= 0.0) & (heights <= 1.0)).all()
    return ("read", "") if right else ("no heights", f"{heights.dtype} {heights.shape}")


def inputs(count: int, seed: int, only: int | None = None) -> Iterator[tuple[int, Item, bytes]]:
    """Yield number, origin and bytes of the changed files; each follows from seed and number alone."""
    origins = items()
    for k in range(count) if only is None else [only]:
        chance = random.Random(f"{seed} {k}")
        item = chance.choice(origins)
        yield k, item, changed(item.data, chance)


def tally(folder: Path, count: int, seed: int, only: int | None = None) -> Counter[str]:
    """Outcomes of so many inputs; all that must not be is printed."""
    found: Counter[str] = Counter()
    for item in items():
        path = folder / item.name
        path.write_bytes(item.data)
        io.read_height(path, **item.options)  # and what reads them has its own memory
    with limits():
        for k, item, data in inputs(count, seed, only):
            path = folder / item.name
            path.write_bytes(data)
            kind, words = outcome(path, item.options)
            found[kind] += 1
            if kind not in ("read", "refused") or only is not None:
                print(f"{k} ({item.name}): {kind} {words[:300]}")
    return found


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:], __doc__, tally, OUTCOMES))
