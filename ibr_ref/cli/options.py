"""How the values of options are read: numbers in ASCII digits, and what is more than a number. Typer calls these.

Nothing else is taken for a number: no digits of other scripts, no `1_000`, no `0x10`. What a number may be is said by the
field that it is for. Defaults are values already and stay.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from enum import StrEnum
from functools import wraps
from pathlib import Path
from typing import Annotated, NamedTuple, TypeVar

import typer


def choices(name: str, values: Iterable[str], doc: str) -> type[StrEnum]:
    """An enumeration of words that another module lists, for Typer; its members are strings."""
    made: type[StrEnum] = StrEnum(name, {value: value for value in values})  # type: ignore[misc]
    made.__doc__ = doc
    return made


def _joined(values: Iterable[float]) -> str:
    """As it is typed."""
    return ",".join(map(repr, values))


class Vector(NamedTuple):
    """A point or a direction in world space."""

    x: float
    y: float
    z: float

    def __str__(self) -> str:
        return _joined(self)


class Pair(NamedTuple):
    """A size in world units, a place on a plane, or a range."""

    x: float
    y: float

    def __str__(self) -> str:
        return _joined(self)


class Size(NamedTuple):
    """Of a picture, pixels."""

    width: int
    height: int

    def __str__(self) -> str:
        return f"{self.width}x{self.height}"


class Law(NamedTuple):
    """Of the width of splats."""

    alpha: float
    beta: float
    gamma: float
    delta: float

    def __str__(self) -> str:
        return _joined(self)


class Cameras(tuple[int, ...]):
    """Their numbers; none: all that there are."""

    def __str__(self) -> str:
        return _joined(self) or "all"


class Numbers(tuple[float, ...]):
    """As many as a matrix or a pinhole has."""

    def __str__(self) -> str:
        return _joined(self)


class View(NamedTuple):
    """A camera, or two and how far it is from the first to the second."""

    first: int
    second: int | None
    fraction: float

    def __str__(self) -> str:
        return str(self.first) if self.second is None else f"{self.first}:{self.second}:{self.fraction:g}"


Value = TypeVar("Value")

_NUMBER = re.compile(r"\s*[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?\s*", re.ASCII | re.IGNORECASE)
_NOT_FINITE = re.compile(r"[+-]?(inf|infinity|nan)", re.ASCII | re.IGNORECASE)
_WHOLE = re.compile(r"[+-]?\d{1,18}", re.ASCII)


def reads(read: Callable[[str], Value]) -> Callable[[str], Value]:
    """A parser for Typer, which hands it the defaults too."""

    @wraps(read)
    def parser(text: str | Value) -> Value:
        return read(text) if isinstance(text, str) else text

    return parser


def bad(text: str, allowed: str) -> typer.BadParameter:
    """The error for an option's value."""
    from ibr_ref.scene.checks import one_line  # here: an answer to --help must not wait for NumPy

    return typer.BadParameter(f"found {one_line(repr(text))}, allowed: {allowed}")


@reads
def repeats(text: str) -> int:
    """How often something is done: 1 to 1000."""
    if not _WHOLE.fullmatch(text) or not 1 <= int(text) <= 1000:
        raise bad(text, "a whole number from 1 to 1000")
    return int(text)


def _finite(text: str) -> float:
    value = float(text) if _NUMBER.fullmatch(text) else math.nan
    return value if math.isfinite(value) else math.nan


@reads
def number(text: str) -> float:
    """One number. Fields say themselves that inf and nan are none."""
    if not (_NUMBER.fullmatch(text) or _NOT_FINITE.fullmatch(text)):
        raise bad(text, "a number, such as 0.15")
    return float(text)


@reads
def whole(text: str) -> int:
    """One whole number."""
    if not _WHOLE.fullmatch(text):
        raise bad(text, "a whole number, such as 9")
    return int(text)


Out = Annotated[Path, typer.Option(help="The picture: .png, .jpg, or .exr (floats; needs ibr_ref[io]).")]
Bits = Annotated[int, typer.Option(parser=whole, help="Of each colour in a .png: 8 or 16.")]
Near = Annotated[
    float | None, typer.Option(parser=number, help="Distance of the near plane. Without: before all that is there.")
]
Far = Annotated[
    float | None, typer.Option(parser=number, help="Distance of the far plane. Without: behind all that is there.")
]


def _numbers(text: str, count: int, example: str) -> tuple[float, ...]:
    values = tuple(map(_finite, text.split(",")))
    if len(values) != count or any(map(math.isnan, values)):
        raise bad(text, f"{count} numbers, such as {example}")
    return values


@reads
def vector(text: str) -> Vector:
    """X,Y,Z."""
    return Vector(*_numbers(text, 3, "1.0,-2.5,0.3"))


@reads
def pair(text: str) -> Pair:
    """W,H in world units, or the place X,Y of an object."""
    return Pair(*_numbers(text, 2, "0.3,0.2"))


@reads
def one_or_two(text: str) -> Pair:
    """A, which stands for A,A, or A,B."""
    return Pair(*_numbers(text if "," in text else f"{text},{text}", 2, "30 or 20,30"))


@reads
def law(text: str) -> Law:
    """A,B,C,D of a splat law."""
    return Law(*_numbers(text, 4, "1,0,0.002,0.7"))


@reads
def intrinsics(text: str) -> Numbers:
    """FX,FY,CX,CY of a pinhole, pixels."""
    return Numbers(_numbers(text, 4, "525,525,319.5,239.5"))


@reads
def pose(text: str) -> Numbers:
    """A matrix, row by row: 12 numbers, or 16."""
    return Numbers(_numbers(text, 16 if text.count(",") == 15 else 12, "1,0,0,0,0,1,0,0,0,0,1,0"))


@reads
def cameras(text: str) -> Cameras:
    """I,J,..: numbers of cameras; or all."""
    if text == "all":
        return Cameras()
    parts = text.split(",")
    if not all(part[:1].isdigit() and _WHOLE.fullmatch(part) for part in parts):
        raise bad(text, "numbers of cameras, such as 0 or 0,1, or all")
    return Cameras(map(int, parts))


@reads
def view(text: str) -> View:
    """I, I:J or I:J:F: one camera, or two and how far it is from the first to the second."""
    first, *rest = text.split(":")
    where = _finite(rest[1]) if len(rest) == 2 else 0.5
    between = [first, *rest[:1]]
    if len(rest) > 2 or not all(n[:1].isdigit() and _WHOLE.fullmatch(n) for n in between) or not 0.0 <= where <= 1.0:
        raise bad(text, "a camera, such as 1, or two and a fraction in [0, 1], such as 0:1 or 0:1:0.25")
    return View(int(first), int(rest[0]) if rest else None, where)


@reads
def size(text: str) -> Size:
    """WIDTHxHEIGHT in pixels."""
    parts = text.lower().split("x")
    if len(parts) != 2 or not all(part[:1].isdigit() and _WHOLE.fullmatch(part) for part in parts):
        raise bad(text, "WIDTHxHEIGHT in pixels, such as 640x480")
    width, height = int(parts[0]), int(parts[1])
    if not (1 <= width <= 65536 and 1 <= height <= 65536 and width * height <= 2**28):
        raise bad(text, "sides from 1 to 65536, at most 2^28 pixels")
    return Size(width, height)


def up(eye: Vector, target: Vector) -> Vector:
    """The direction that is up in a picture where z is: y for a view straight down or up."""
    return Vector(0.0, 0.0, 1.0) if eye[:2] != target[:2] else Vector(0.0, 1.0, 0.0)
