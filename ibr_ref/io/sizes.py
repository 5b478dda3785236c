"""The largest image that is read."""

from __future__ import annotations

_MAX_PIXELS = 2**28


def check_size(width: int, height: int) -> None:
    """Raise ValueError for a size, as the file's header has it, that is not at least 1 x 1 and at most 2^28 pixels."""
    if width < 1 or height < 1 or width * height > _MAX_PIXELS:
        raise ValueError(f"found {width} x {height} pixels, allowed: 1 x 1 to {_MAX_PIXELS} pixels (2^28) in all")
