"""`manifest.json`: what a case's folder holds, with the hash of each file."""

from __future__ import annotations

import hashlib
from typing import Annotated, Literal

from pydantic import Field

from ibr_ref.oracle.files.npy import HASHED
from ibr_ref.oracle.schema.base import FileName, Model

Hash = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Manifest(Model):
    """Every file of the folder but itself."""

    format: Literal["ibr_ref manifest"] = "ibr_ref manifest"
    version: Literal[1] = 1
    hashed: str = HASHED
    """What the hashes of arrays are made of."""
    arrays: dict[FileName, Hash]
    """By file; of the decoded array."""
    documents: dict[Literal["case.json", "README.md"], Hash]
    """By file; SHA-256 of its bytes."""


def digest_of_bytes(data: bytes) -> str:
    """Of a document."""
    return hashlib.sha256(data).hexdigest()
