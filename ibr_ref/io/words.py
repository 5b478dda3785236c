"""Numbers as the text formats of meshes write them: Python's own reader takes `1_0` for 10."""

from __future__ import annotations


def real(word: bytes) -> float:
    """A decimal number; `nan` and `inf`, which C's printf writes, come through. ValueError for all else."""
    if b"_" in word:
        raise ValueError
    return float(word)


def whole(word: bytes) -> int:
    """A decimal whole number. ValueError for all else."""
    if b"_" in word:
        raise ValueError
    return int(word)


def shown(words: list[bytes]) -> str:
    """The words of a statement, to be shown in a message."""
    text = b" ".join(words).decode("latin-1")
    return repr(text if len(text) <= 60 else text[:57] + "...")
