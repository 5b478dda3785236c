"""What a port may hand in under each name: types and shapes, before a file is read, and the arrays as referees get them."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.contract import described
from ibr_ref.oracle.accept.bytes import read_back
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.files.npy import Accept, Header
from ibr_ref.oracle.files.pictures import turned
from ibr_ref.oracle.files.problem import UnusableError
from ibr_ref.oracle.schema.document import schema_of
from ibr_ref.oracle.schema.stages import contract_of, expected

_KINDS = {
    "f": ("f", "float32 or float64"),
    "i": ("iu", "integers"),
    "u": ("iu", "integers"),
    "b": ("biu", "booleans, or integers 0 and 1"),
}
"""By the kind of the reference's array: the kinds that are allowed, and in words. Integers are never floats."""


@dataclass(frozen=True)
class Slot:
    """A name under which an array is handed in."""

    name: str
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    """The reference's."""
    most_faces: int = 0
    """Of an array with four rows a face: how many it may have, right or not. Too many or too few are the port's fault."""

    @property
    def shapes(self) -> list[tuple[int, ...]]:
        """Allowed shapes; the final colour may come with an alpha, which is not looked at."""
        if self.most_faces:
            return [(4 * faces, *self.shape[1:]) for faces in range(self.most_faces + 1)]
        return [self.shape, (*self.shape[:2], 4)] if self.name == "color" else [self.shape]

    def check(self, header: Header, file: object) -> None:
        """Raise UnusableError for another type or shape."""
        kinds, words = _KINDS[self.dtype.kind]
        is_bytes = self.name == "color" and header.dtype == np.uint8
        if header.dtype.kind not in kinds and not is_bytes:
            allowed = f"{words}{', or uint8' if self.name == 'color' else ''}"
            raise UnusableError(file, f"{header.dtype}", allowed)
        if header.dtype.kind == "f" and header.dtype.itemsize not in (4, 8):
            # 11 bits: no device is that coarse, and a correct port would be accused of its read-back.
            raise UnusableError(file, f"{header.dtype}", words)
        if header.shape not in self.shapes:
            remark = turned(header.shape, self.shape)
            allowed = f"four rows a face, {self.shape}" if self.most_faces else " or ".join(map(str, self.shapes))
            raise UnusableError(file, f"the shape {header.shape}{remark}", allowed)

    def accept(self, file: object) -> Accept:
        """The check of a file's header."""
        return lambda header: self.check(header, file)

    def converted(self, array: NDArray[Any], file: object) -> NDArray[Any]:
        """The array in the reference's type, floats as float64; colours that are, or were, bytes as bytes."""
        self.check(Header(array.dtype, array.shape, 0), file)
        if self.name == "color":
            array = array[..., :3]
        result: NDArray[Any]
        if array.dtype.kind == "f":
            result = array.astype(np.float64)
            if self.name == "color":
                result = read_back(result)
        elif self.name == "color":
            result = array.copy()
        else:
            low, high = (0, 1) if self.dtype.kind == "b" else (np.iinfo(self.dtype).min, np.iinfo(self.dtype).max)
            if array.dtype.kind != "b" and array.size and not (low <= int(array.min()) and int(array.max()) <= high):
                raise UnusableError(file, f"numbers from {array.min()} to {array.max()}", f"{low} to {high}")
            result = array.astype(self.dtype)
        result = np.ascontiguousarray(result)
        result.setflags(write=False)
        return result


class Slots:
    """All names of a case; drawn from its frame."""

    def __init__(self, case: Case) -> None:
        contract = contract_of(case.method)
        most_faces = schema_of(case.method).most_faces(case.scene)
        self.by_name = {
            name: Slot(
                name,
                array.shape,
                np.dtype(described(contract, name).dtype),
                most_faces.get(name, 0),
            )
            for name, array in expected(case.frame).items()
        }
        self.pages = {name: len(case.frame.stages[name]) for name, entry in contract.items() if entry.paged}
        """Of the stages of several arrays."""

    def named(self, name: str, file: object) -> Slot:
        """The slot of that name. Raises UnusableError for an unknown one, which would never be judged."""
        if name not in self.by_name:
            near = difflib.get_close_matches(name, self.by_name, 1, 0.5)
            hint = f"{near[0]}, perhaps; " if near else ""
            raise UnusableError(file, f"the unknown name {name!r}", f"{hint}the names of case.json, `expected`")
        return self.by_name[name]

    def joined(self, arrays: dict[str, NDArray[Any]]) -> tuple[dict[str, Any], list[str]]:
        """The arrays with pages joined to tuples, in the contract's order, and the names of missing pages."""
        missing, result = [], {}
        for name in _stages(self.by_name, self.pages):
            pages = [f"{name}.{page}" for page in range(self.pages.get(name, 0))] or [name]
            absent = [page for page in pages if page not in arrays]
            if not absent:
                result[name] = tuple(arrays[page] for page in pages) if name in self.pages else arrays[name]
            elif len(absent) < len(pages):
                missing += absent
        return result, missing


def _stages(names: Iterable[str], pages: dict[str, int]) -> list[str]:
    """The contract's names without the numbers of pages, each once."""
    stages = (name.rpartition(".")[0] if name.rpartition(".")[0] in pages else name for name in names)
    return list(dict.fromkeys(stages))
