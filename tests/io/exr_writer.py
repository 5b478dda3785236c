"""A plain OpenEXR writer: scan lines as they are or, sixteen at a time, ZIP-compressed, and headers that lie."""

import struct
import zlib

import numpy as np

TYPES = {"uint32": 0, "float16": 1, "float32": 2}
LINES = {0: 1, 3: 16}


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def encode(channels, *, zipped=False, sampling=1, window=None, size=None, flags=0):
    """EXR of arrays (H, W) by name, of one size. window: the display's (x0, y0, x1, y1); size: a false (W, H)."""
    planes = {name: np.asarray(plane) for name, plane in sorted(channels.items())}
    height, width = next(iter(planes.values())).shape
    box = (0, 0, (size or (width, height))[0] - 1, (size or (width, height))[1] - 1)
    compression = 3 if zipped else 0
    listed = b"".join(
        name.encode() + b"\0" + struct.pack("<iB3xii", TYPES[plane.dtype.name], 0, sampling, sampling)
        for name, plane in planes.items()
    )
    head = struct.pack("<II", 20000630, 2 | flags)
    head += attribute("channels", "chlist", listed + b"\0")
    head += attribute("compression", "compression", bytes([compression]))
    head += attribute("dataWindow", "box2i", struct.pack("<4i", *box))
    head += attribute("displayWindow", "box2i", struct.pack("<4i", *(window or box)))
    head += attribute("lineOrder", "lineOrder", b"\0")
    head += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    head += attribute("screenWindowCenter", "v2f", bytes(8))
    head += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    chunks = []
    for y in range(0, height, LINES[compression]):
        rows = range(y, min(y + LINES[compression], height))
        raw = b"".join(
            plane[row].astype(plane.dtype.newbyteorder("<")).tobytes() for row in rows for plane in planes.values()
        )
        packed = squeezed(raw) if zipped else raw
        packed = packed if len(packed) < len(raw) else raw
        chunks.append(struct.pack("<ii", y, len(packed)) + packed)
    places = np.cumsum([len(head) + 8 * len(chunks), *map(len, chunks)])[:-1]
    return head + places.astype("<u8").tobytes() + b"".join(chunks)


def squeezed(raw):
    """Even bytes before odd ones, each as its difference from the one before and 128, deflated."""
    sorted_ = np.frombuffer(raw[::2] + raw[1::2], np.uint8).astype(int)
    steps = np.concatenate([sorted_[:1], (np.diff(sorted_) + 128) % 256])
    return zlib.compress(steps.astype(np.uint8).tobytes())
