"""Digests by which work that was interrupted is told from other work: the same wherever a description was made."""

from __future__ import annotations

import hashlib
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

PACKAGE = Path(__file__).parents[1]


def digest_of(*values: Any) -> str:
    """SHA-256 of descriptions: fields of dataclasses, elements of sequences, numbers, words, arrays; and of the sources."""
    digest = hashlib.sha256(sources_digest().encode())
    _add(digest, values)
    return digest.hexdigest()


@cache
def sources_digest() -> str:
    """SHA-256 of the package's sources, by which other versions are told."""
    found = hashlib.sha256()
    for source in sorted(PACKAGE.rglob("*.py")):
        found.update(source.relative_to(PACKAGE).as_posix().encode() + source.read_bytes())
    return found.hexdigest()


def _add(digest: Any, value: Any) -> None:
    if is_dataclass(value) and not isinstance(value, type):
        digest.update(f"{type(value).__qualname__}(".encode())
        for field in fields(value):
            digest.update(f"{field.name}=".encode())
            _add(digest, getattr(value, field.name))
    elif isinstance(value, np.ndarray):
        digest.update(f"{value.dtype.str}{value.shape}".encode() + value.tobytes())
    elif isinstance(value, (tuple, list)):
        digest.update(f"[{len(value)}]".encode())
        for each in value:
            _add(digest, each)
    else:
        digest.update(f"{type(value).__qualname__} {value!r};".encode())
