"""A plain PNG writer: every colour type, depth and interlacing, and headers that lie."""

import struct
import zlib

import numpy as np

SIGNATURE = b"\x89PNG\r\n\x1a\n"
COLOR_TYPES = {1: 0, 2: 4, 3: 2, 4: 6}
PASSES = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]


def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def header(width, height, bits=8, color_type=0, interlace=0):
    return chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, color_type, 0, 0, interlace))


def scanlines(samples, bits):
    """Rows, each behind its filter byte: 0 none, or 1, the difference from the pixel to the left, by turns."""
    height, _, channels = samples.shape
    if bits < 8:
        values = (samples[..., None] >> np.arange(bits - 1, -1, -1)) & 1
        rows = np.packbits(values.reshape(height, -1).astype(np.uint8), axis=1)
    else:
        rows = samples.astype(">u2" if bits == 16 else "u1").reshape(height, -1).view(np.uint8)
    step = max(1, bits * channels // 8)
    lines = []
    for y, row in enumerate(rows):
        before = np.concatenate([np.zeros(step, np.uint8), row])[: len(row)]
        lines.append(bytes([y % 2]) + (row - before if y % 2 else row).tobytes())
    return b"".join(lines)


def encode(samples, bits, *, color_type=None, interlaced=False, before=b"", size=None):
    """PNG of unsigned samples (H, W) or (H, W, C); `before`: chunks put ahead of the pixels; `size`: a false (W, H)."""
    samples = np.asarray(samples)
    samples = samples.reshape(*samples.shape[:2], -1)
    height, width, channels = samples.shape
    parts = [samples[y::dy, x::dx] for x, y, dx, dy in PASSES] if interlaced else [samples]
    pixels = b"".join(scanlines(part, bits) for part in parts if part.size)
    color_type = COLOR_TYPES[channels] if color_type is None else color_type
    return b"".join(
        [
            SIGNATURE,
            header(*(size or (width, height)), bits, color_type, int(interlaced)),
            before,
            chunk(b"IDAT", zlib.compress(pixels)),
            chunk(b"IEND", b""),
        ]
    )
