"""What a port hands in: a folder, an archive, or arrays."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.declaration import ANY, Declaration, declared, of_fields
from ibr_ref.oracle.files.archive import member, opened
from ibr_ref.oracle.files.content import content_problems
from ibr_ref.oracle.files.folder import existing_folder, file_inside, small_file
from ibr_ref.oracle.files.handed import Slots
from ibr_ref.oracle.files.npy import read_array
from ibr_ref.oracle.files.pictures import read_bytes
from ibr_ref.oracle.files.problem import Problem, UnusableError

_LARGEST_NOTE = 2**16
_NOTE = 'a JSON object, such as {"profile": "gl", "subpixel_bits": 4}'
_UNREADABLE, _README = "what cannot be read", "a file as the case's README says"


@dataclass(frozen=True, kw_only=True, eq=False)
class Submission:
    """The arrays that can be used, and what is wrong with the others."""

    source: str
    """Where it came from."""
    handed: Mapping[str, Any]
    """By their names in the contract: colour as uint8 or float64, other floats as float64, integers and flags in the
    reference's types; an atlas as a tuple of pages."""
    problems: tuple[Problem, ...]
    """Any makes the verdict INCONCLUSIVE: files that cannot be used."""
    declaration: Declaration
    """What the port says of its device."""
    files: Mapping[str, str] = field(default_factory=dict)
    """Where each array came from."""

    @property
    def profile(self) -> str | None:
        """The profile in it."""
        return self.declaration.profile

    @property
    def usable(self) -> bool:
        """Whether it can be judged."""
        return not self.problems


def load_submission(folder: str | PathLike[str], case: Case) -> Submission:
    """Read a folder with any of NAME.npy, color.png, archives (.npz) of the same names, and port.json; or one archive.

    NAME is that of an expected array of the case; of an atlas each page has its own. Other files are not looked at, but
    a .npy under another name is a problem: it would not be judged. Arrays must be little-endian and in C order. Renders
    the case. Raises OSError where there is no folder and no archive.
    """
    path = Path(folder)
    single = path.suffix == ".npz" and os.path.isfile(path)
    root = existing_folder(path.parent if single else path)
    collector = _Collector(case)
    for name in [path.name] if single else sorted(os.listdir(root)):
        collector.add_file(root, name)
    return collector.submission(str(path))


def submission_from_arrays(
    case: Case,
    *,
    color: Any = None,
    depth: Any = None,
    stages: Mapping[str, Any] | None = None,
    profile: str | None = None,
) -> Submission:
    """The same of arrays in memory: NumPy's, and whatever has `__dlpack__` (in the CPU's memory) or `__array__`.

    stages: by name; of an atlas a sequence of pages, or "atlas.color.0" and so on. Any memory order will do. Raises
    ValueError for an unknown device.
    """
    collector = _Collector(case)
    if profile is not None:
        collector.declaration = declared(profile)
    for name, value in {"color": color, "depth": depth, **(stages or {})}.items():
        if value is not None:
            collector.add_value(str(name), value)
    return collector.submission("arrays")


class _Collector:
    """A submission while it is being read."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.slots = Slots(case)
        self.arrays: dict[str, NDArray[Any]] = {}
        self.files: dict[str, str] = {}
        """Where each array came from."""
        self.problems: list[Problem] = []
        self.declaration = ANY

    def submission(self, source: str) -> Submission:
        handed, missing = self.slots.joined(self.arrays)
        self.problems += [Problem(name, "no such page", "all pages of an atlas, or none") for name in missing]
        if not self.problems:
            self.problems += content_problems(self.case, handed, self.files)
        return Submission(
            source=source,
            handed=handed,
            problems=tuple(self.problems),
            declaration=self.declaration,
            files=self.files,
        )

    def add_file(self, root: Path, name: str) -> None:
        """A file of the folder, if it is one that counts."""
        readers: dict[str, Callable[[Path, str], None]] = {
            ".npy": self._add_array,
            ".npz": self._add_archive,
        }
        reader = readers.get(Path(name).suffix)
        reader = {"color.png": self._add_picture, "port.json": self._add_note}.get(name, reader)
        if reader is not None and not name.startswith("."):
            self.problems += _problems(name, partial(reader, root, name))

    def add_value(self, name: str, value: Any) -> None:
        """An array in memory, or the pages of an atlas."""
        pages = [(name, value)]
        if name in self.slots.pages and isinstance(value, Sequence):
            pages = [(f"{name}.{page}", item) for page, item in enumerate(value)]
        for page, item in pages:
            self.problems += _problems(page, partial(self._add_item, page, item))

    def _add_item(self, name: str, value: Any) -> None:
        self._keep(name, _array(value, name), name)

    def _add_array(self, root: Path, name: str) -> None:
        slot = self.slots.named(name.removesuffix(".npy"), name)
        self._keep(slot.name, read_array(file_inside(root, name, name), slot.accept(name), name), name)

    def _add_picture(self, root: Path, name: str) -> None:
        shapes = self.slots.by_name["color"].shapes
        self._keep("color", read_bytes(file_inside(root, name, name), shapes, name), name)

    def _add_archive(self, root: Path, name: str) -> None:
        with opened(file_inside(root, name, name), name) as archive:
            for info in archive.infolist():
                file = f"{name}/{info.filename}"
                slot = self.slots.named(info.filename.removesuffix(".npy"), file)
                self._keep(slot.name, member(archive, info, slot, file), file)

    def _add_note(self, root: Path, name: str) -> None:
        """{"profile": "gl", "subpixel_bits": 4}: all may be left out."""
        try:
            fields = json.loads(small_file(root, name, _LARGEST_NOTE, name))
        except (ValueError, RecursionError):
            raise UnusableError(name, "what is no JSON", _NOTE) from None
        if not isinstance(fields, dict):
            raise UnusableError(name, f"a {type(fields).__name__}", _NOTE)
        try:
            self.declaration = of_fields(fields)
        except ValueError as error:
            field, _, rest = str(error).partition(": found ")
            found, _, allowed = rest.partition(", allowed: ")
            raise UnusableError(f"{name}: {field}", found, allowed) from None

    def _keep(self, name: str, array: NDArray[Any], file: str) -> None:
        if name in self.arrays:
            raise UnusableError(file, f"a second {name}, after {self.files[name]}", "one of them")
        self.arrays[name] = self.slots.named(name, file).converted(array, file)
        self.files[name] = file


def _problems(file: str, read: Callable[[], None]) -> Iterator[Problem]:
    """What is wrong with a file, if anything: whatever reading it raises."""
    try:
        read()
    except UnusableError as error:
        yield error.problem
    except MemoryError:
        yield Problem(file, "what does not fit in memory", "arrays that do")
    except OSError as error:
        yield Problem(file, f"what cannot be read ({error.strerror or 'no reason given'})", "a file that can be read")
    except ValueError as error:  # of `naming`, which starts with the path
        yield Problem(file, str(error).partition(": found ")[2].partition(", allowed: ")[0] or _UNREADABLE, _README)
    except Exception:  # bad data break decoders in any way; a port's file must never end in a traceback
        yield Problem(file, _UNREADABLE, _README)


def _array(value: Any, name: str) -> NDArray[Any]:
    """NumPy's view of an array."""
    kinds = "an array of NumPy, or with __dlpack__ (in the CPU's memory) or __array__"
    try:
        if isinstance(value, np.ndarray):
            array = value
        elif hasattr(value, "__dlpack__") and hasattr(value, "__dlpack_device__"):
            array = np.from_dlpack(value)
        elif hasattr(value, "__array__"):
            array = np.asarray(value)
        else:
            raise UnusableError(name, f"{type(value).__name__}", kinds)
    except UnusableError:
        raise
    except Exception:  # of any library
        raise UnusableError(name, f"{type(value).__name__}, which gives no array", kinds) from None
    if array.dtype.kind not in "biuf":
        raise UnusableError(name, f"an array of {array.dtype}", "booleans, integers or floats")
    return array
