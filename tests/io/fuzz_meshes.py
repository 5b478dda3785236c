"""Mesh files of the corpus, changed by chance: each is read as the second parser reads it, or refused in one line.

    python -m tests.io.fuzz_meshes --count 50000

prints how many were read and refused, and each input that was neither: `--only K` reads that one again, `--seed` others.
"""

from __future__ import annotations

import json
import random
import re
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from ibr_ref import io
from tests.io import corpus, plain
from tests.io.fuzzing import LONGEST_MESSAGE, TooLong, clock, limits, run
from tests.io.same_surface import difference

LARGEST = 20_000
"""Bytes of a file that is changed."""

_NUMBER = re.compile(rb"-?\d+(\.\d+)?")
_NUMBERS = [b"0", b"-1", b"1", b"2", b"3", b"255", b"256", b"65535", b"65536", b"2147483647", b"4294967296", b"1e30", b"nan",
            b"99999999999999999999", b"1_0", b"0.5", b"-0", b"1e999", b"", b"x"]  # fmt: skip
_WORDS = [
    b"f 1 2 3", b"f -1 -2 -3 -4", b"v 0 0", b"v 1 2 3", b"l 1 2", b"#", b"\\", b"endsolid", b"endloop", b"vertex 1 2 3",
    b"facet normal 0 0 1", b"property float x", b"element face 3", b"end_header", b"format ascii 1.0", b"comment",
    b"3 0 1 2", b"4 0 1 2 3", b"\xef\xbb\xbf", b"\x00",
]  # fmt: skip
_VALUES = [0, 1, 2, 3, 4, 5, 6, 12, 255, 65535, 2**31, 2**53, -1, 0.5, 1e300, 1e39, True, None, "", "2.0", [], {}, [0],
           5120, 5121, 5123, 5125, 5126, "SCALAR", "VEC3", "VEC4"]  # fmt: skip


def changed(item: corpus.Item, chance: random.Random) -> bytes:
    """The file's bytes after one to three changes."""
    data = item.data
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        if item.name.endswith(("gltf", "glb")) and chance.random() < 0.7:
            data = _in_document(data, chance)
        else:
            change = chance.choice(
                (_flipped, _cut, _longer, _other_line, _other_number, _swapped, _other_digit, _flipped)
            )
            data = change(data, chance) if data else data
    return data


def _flipped(data: bytes, chance: random.Random) -> bytes:
    place = chance.randrange(chance.choice((0, len(data) // 2)), len(data))
    if chance.random() < 0.3:
        place = chance.randrange(min(len(data), 200))
    return data[:place] + bytes([data[place] ^ 1 << chance.randrange(8)]) + data[place + 1 :]


def _cut(data: bytes, chance: random.Random) -> bytes:
    begin, end = sorted(chance.randrange(len(data) + 1) for _ in range(2))
    return chance.choice((data[:end], data[begin:], data[:begin] + data[end:]))


def _longer(data: bytes, chance: random.Random) -> bytes:
    begin, end = sorted(chance.randrange(len(data) + 1) for _ in range(2))
    return chance.choice((data[:end] + data[begin:], data + bytes(chance.randrange(1, 99)), data + data[begin:end]))


def _other_line(data: bytes, chance: random.Random) -> bytes:
    lines = data.split(b"\n")
    place = chance.randrange(len(lines))
    line = chance.choice((*_WORDS, chance.choice(lines)))
    kept = chance.choice(([], lines[place : place + 1]))
    return b"\n".join([*lines[:place], *([line] if chance.random() < 0.7 else []), *kept, *lines[place + 1 :]])


def _other_number(data: bytes, chance: random.Random) -> bytes:
    found = list(_NUMBER.finditer(data, 0, chance.choice((300, len(data)))))
    if not found:
        return data
    match = chance.choice(found)
    return data[: match.start()] + chance.choice(_NUMBERS) + data[match.end() :]


def _other_digit(data: bytes, chance: random.Random) -> bytes:
    """A number that is much like the one before, and as long."""
    places = [match.start() for match in re.finditer(rb"\d", data)]
    if not places:
        return data
    place = chance.choice(places)
    return data[:place] + chance.choice(b"0123456789").to_bytes(1, "big") + data[place + 1 :]


def _swapped(data: bytes, chance: random.Random) -> bytes:
    """Two words changed for one another."""
    found = list(re.finditer(rb"\S+", data[: chance.choice((300, 3000))]))
    if len(found) < 2:
        return data
    first, second = sorted(chance.sample(found, 2), key=lambda match: match.start())
    return data[: first.start()] + second[0] + data[first.end() : second.start()] + first[0] + data[second.end() :]


def _in_document(data: bytes, chance: random.Random) -> bytes:
    """A field of a glTF document changed, and the container made to fit."""
    size = int.from_bytes(data[12:16], "little")
    text = data[20 : 20 + size] if data[:4] == b"glTF" else data
    try:
        tree = json.loads(text)
        places = list(_places(tree))
    except (ValueError, RecursionError):
        return data
    if not places:
        return data
    holder, key = chance.choice(places)
    kind = chance.random()
    if kind < 0.15:
        del holder[key]
    elif kind < 0.3 and isinstance(holder, list):
        holder.append(holder[key])
    elif kind < 0.5:
        other, name = chance.choice(places)
        holder[key] = json.loads(json.dumps(other[name]))
    elif isinstance(holder[key], int) and kind < 0.7:
        holder[key] += chance.choice((-1, 1, 4, -4))
    else:
        holder[key] = chance.choice(_VALUES)
    made = json.dumps(tree).encode()
    if data[:4] != b"glTF":
        return made
    made += b" " * (-len(made) % 4)
    body = len(made).to_bytes(4, "little") + b"JSON" + made + data[20 + size :]
    return data[:8] + (12 + len(body)).to_bytes(4, "little") + body


def _places(tree: object) -> Iterator[tuple[object, object]]:
    """Yield every field and every element of a document."""
    pairs = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in list(pairs):
        yield tree, key
        yield from _places(value)


def outcome(path: Path) -> tuple[str, str]:
    """What became of a file: read, refused, or what must not be, and how."""
    try:
        with clock():
            mesh = io.read_mesh(path)
    except TooLong:
        return "hang", ""
    except (OSError, ValueError) as error:
        return _message(str(error), str(path))
    except Exception as error:
        return "traceback", f"{type(error).__name__} {error}"
    try:
        problem = difference(mesh, plain.read(path))
    except plain.Refused as error:
        problem = f"refused by the second parser: {error}"
    return ("disagreement", problem) if problem else ("read", "")


def _message(text: str, path: str) -> tuple[str, str]:
    said = text.removeprefix(f"{path}: ")
    if "does not fit in memory" in said:
        return "memory", said
    if said.startswith("found what cannot be decoded") or said == text:
        return "undocumented", text
    addresses = said.replace("http://example.org", "")  # of the corpus, quoted
    if len(said) > LONGEST_MESSAGE or "\n" in said or "http" in addresses:
        return "message", said
    return "refused", said


def inputs(count: int, seed: int, only: int | None = None) -> Iterator[tuple[int, corpus.Item, bytes]]:
    """Yield number, origin and bytes of the changed files; each follows from seed and number alone."""
    items = [item for item in corpus.items() if 0 < len(item.data) <= LARGEST]
    whole = [item for item in items if item.refusal is None]
    for k in range(count) if only is None else [only]:
        chance = random.Random(f"{seed} {k}")
        item = chance.choice(whole if chance.random() < 0.8 else items)
        yield k, item, changed(item, chance)


OUTCOMES = ("read", "refused", "disagreement", "traceback", "undocumented", "hang", "memory", "message")


def tally(folder: Path, count: int, seed: int, only: int | None = None) -> Counter[str]:
    """Outcomes of so many inputs; all that must not be is printed."""
    for item in corpus.items():
        item.written(folder)  # those that others refer to
    found: Counter[str] = Counter()
    with limits():
        for k, item, data in inputs(count, seed, only):
            path = folder / f"changed-{item.name}"
            path.write_bytes(data)
            kind, words = outcome(path)
            found[kind] += 1
            if kind not in ("read", "refused") or only is not None:
                print(f"{k} ({item.name}): {kind} {words[:300]}")
            path.unlink()
    return found


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:], __doc__, tally, OUTCOMES))
