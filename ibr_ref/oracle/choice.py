"""Cases as people choose them: by name, by pattern, or as folders of their own beside the built-in ones."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import partial
from pathlib import Path

from ibr_ref.oracle import cases
from ibr_ref.oracle.cases.case import Case
from ibr_ref.scene import checks

ALL = "all"
"""Every built-in case."""
PROBE = "probe"
"""What the names of the cases begin with from which devices are measured; they are none of all."""


@dataclass(frozen=True)
class Choice:
    """A case that is not built or read yet."""

    name: str
    """Of a built-in case, or of the folder."""
    folder: Path | None
    """None: built in."""
    make: Callable[[], Case]
    """Raises ValueError or OSError, one line, for a folder that is no case."""


def chosen(words: Iterable[str]) -> list[Choice]:
    """What the words choose, in their order, each once.

    A word is `all`, `probe`, a built-in case's name or a pattern of some ("displacement-*"), or a folder: a case's, or one
    with cases in it. Raises ValueError for a word that chooses nothing.
    """
    found: dict[tuple[str, Path | None], Choice] = {}
    for word in words:
        choices = _chosen(word)
        if not choices:
            raise checks.reject("case", word, f"a folder with cases, {ALL}, or names and patterns of {_names()}")
        found.update(((choice.name, choice.folder), choice) for choice in choices)
    return list(found.values())


def is_many(word: str) -> bool:
    """Whether a word may stand for several cases: `all`, `probe`, a pattern, or a folder that is no case itself."""
    if os.path.isdir(word):
        return not holds_case(Path(word))
    return word in (ALL, PROBE) or any(sign in word for sign in "*?[")


def holds_case(folder: Path) -> bool:
    """Whether the folder is a case's, whole or not."""
    return os.path.isfile(folder / "case.json")


def inside(folder: Path) -> list[Path]:
    """The folders in a folder, by name; hidden ones are not looked at."""
    return sorted(each for each in folder.iterdir() if not each.name.startswith(".") and each.is_dir())


def _chosen(word: str) -> Sequence[Choice]:
    if os.path.isdir(word):
        folder = Path(word)
        found = [folder] if holds_case(folder) else [each for each in inside(folder) if holds_case(each)]
        return [_own(each) for each in found]
    if word.startswith(PROBE):
        from ibr_ref.oracle.probe import PROBES

        rooms = {name: room.open() for name, room in PROBES.items() if word == PROBE or fnmatchcase(name, word)}
        return [Choice(name, None, room.probe_case) for name, room in rooms.items()]
    pattern = "*" if word == ALL else word
    return [Choice(name, None, partial(cases.build, name)) for name in cases.matching(pattern)]


def _own(folder: Path) -> Choice:
    from ibr_ref.oracle.files.load import load_case

    return Choice(folder.resolve().name, folder, partial(load_case, folder))


def _names() -> str:
    """The first word of each method's names, as a pattern would have it."""
    return ", ".join(dict.fromkeys(f"{name.partition('-')[0]}-*" for name in cases.names()))
