"""A mesh file of the corpus."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple


class Item(NamedTuple):
    """A file, and the words of its refusal, or None where it is to be read."""

    name: str
    data: bytes
    refusal: str | None = None
    beside: tuple[tuple[str, bytes], ...] = ()

    def written(self, folder: Path) -> Path:
        """The file in a folder, with those beside it."""
        for name, data in self.beside:
            (folder / name).write_bytes(data)
        path = folder / self.name
        path.write_bytes(self.data)
        return path
