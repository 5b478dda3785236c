"""Options in groups: what Typer sees of them, and what the function gets."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from inspect import signature
from typing import Annotated, Any

import pytest

from ibr_ref.cli.described import beside
from ibr_ref.cli.groups import grouped, told


class Word(StrEnum):
    one = "one"


@dataclass(frozen=True, kw_only=True)
class Inner:
    width: int = 2
    word: Word = Word.one


@dataclass(frozen=True, kw_only=True)
class Outer:
    height: Annotated[int, "of the picture"] = 1
    inner: Inner
    name: str


@grouped
def taken(first: int, outer: Outer, last: int = 3, *, within: Any = None) -> tuple[Any, ...]:
    return first, outer, last, within


@dataclass(frozen=True, kw_only=True)
class Written:
    out: str
    bits: int = 8


@beside(taken)
def command(*, report: bool = False, written: Written, path: str = "", **described: Any) -> Any:
    return report, written, path, described


def test_the_fields_stand_where_the_group_stands() -> None:
    """Of what must be given and of what need not be, one after the other; with the annotations of the fields."""
    parameters = signature(taken).parameters
    assert [*parameters] == ["first", "name", "height", "width", "word", "last", "within"]
    assert parameters["height"].annotation == Annotated[int, "of the picture"]
    assert parameters["word"].default is Word.one


def test_groups_are_made_of_what_is_given() -> None:
    assert taken(first=1, name="n", height=5, within=7) == (1, Outer(height=5, inner=Inner(), name="n"), 3, 7)


def test_what_is_missing_is_said() -> None:
    with pytest.raises(TypeError, match="name"):
        taken(first=1)


def test_a_command_has_its_own_before_those_that_it_hands_on() -> None:
    own = ["out", "first", "name", "report", "bits", "path"]
    assert [*signature(command).parameters] == [*own, "height", "width", "word", "last"]
    assert command(out="a", width=4) == (False, Written(out="a"), "", {"width": 4})


def test_words_are_told_as_plain_strings() -> None:
    found = told(Inner())
    assert found == {"width": 2, "word": "one"}
    assert type(found["word"]) is str
    assert told(Inner(), "word") == {"width": 2}
