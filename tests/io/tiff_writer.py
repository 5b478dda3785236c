"""A plain TIFF writer: strips or tiles, either byte order, Deflate or none, any further tags, and headers that lie."""

import struct
import zlib

import numpy as np

FORMATS = {"u": 1, "i": 2, "f": 3}
SIZES = {"B": 1, "s": 1, "H": 2, "I": 4, "d": 8}
TYPES = {"B": 1, "s": 2, "H": 3, "I": 4, "d": 12}


def blocks(samples, tile, rows):
    """Strips of so many rows, or tiles filled up with zeros."""
    if tile is None:
        return [samples[y : y + rows] for y in range(0, len(samples), rows)]
    cut = []
    for y in range(0, samples.shape[0], tile):
        for x in range(0, samples.shape[1], tile):
            part = samples[y : y + tile, x : x + tile]
            cut.append(np.pad(part, [(0, tile - part.shape[0]), (0, tile - part.shape[1]), (0, 0)]))
    return cut


def encode(samples, *, order="<", tile=None, rows=5, deflate=False, white_is_zero=False, sparse=(), tags=(), lies=()):
    """TIFF of samples (H, W) or (H, W, 3). tags: (number, kind of struct, values); lies: the same, in place of the true
    ones; sparse: numbers of blocks that are left out.
    """
    samples = np.asarray(samples)
    samples = samples.reshape(*samples.shape[:2], -1)
    height, width, channels = samples.shape
    packed = [block.astype(samples.dtype.newbyteorder(order)).tobytes() for block in blocks(samples, tile, rows)]
    packed = [zlib.compress(block) if deflate else block for block in packed]
    packed = [b"" if i in sparse else block for i, block in enumerate(packed)]
    offsets, body = [], b""
    for block in packed:
        offsets.append(8 + len(body) if block else 0)
        body += block
    counts = [len(block) for block in packed]
    entries = {
        256: ("I", [width]),
        257: ("I", [height]),
        258: ("H", [8 * samples.dtype.itemsize] * channels),
        259: ("H", [8 if deflate else 1]),
        262: ("H", [2 if channels == 3 else 1 - white_is_zero]),
        277: ("H", [channels]),
        339: ("H", [FORMATS[samples.dtype.kind]] * channels),
    }
    if tile is None:
        entries |= {273: ("I", offsets), 278: ("I", [rows]), 279: ("I", counts)}
    else:
        entries |= {322: ("I", [tile]), 323: ("I", [tile]), 324: ("I", offsets), 325: ("I", counts)}
    entries |= {number: (kind, values) for number, kind, values in (*tags, *lies)}
    start = 8 + len(body) + len(body) % 2
    head = (b"II" if order == "<" else b"MM") + struct.pack(order + "HI", 42, start)
    return head + body + bytes(len(body) % 2) + directory(entries, order, start)


def directory(entries, order, start):
    """The table of tags, and behind it the values that are longer than four bytes."""
    end = start + 2 + 12 * len(entries) + 4
    table, behind = struct.pack(order + "H", len(entries)), b""
    for number, (kind, values) in sorted(entries.items()):
        raw = values if kind == "s" else struct.pack(f"{order}{len(values)}{kind}", *values)
        count = len(raw) // SIZES[kind]
        if len(raw) > 4:
            place = struct.pack(order + "I", end + len(behind))
            behind += raw + bytes(len(raw) % 2)
        else:
            place = raw.ljust(4, b"\0")
        table += struct.pack(order + "HHI", number, TYPES[kind], count) + place
    return table + bytes(4) + behind
