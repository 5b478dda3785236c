"""Option values that are more than a word or a number."""

from __future__ import annotations

import typer

Vector = tuple[float, float, float]

_MOST_DIGITS = 9


def refused(text: str, allowed: str) -> typer.BadParameter:
    """The error for an option's value."""
    from ibr_ref.scene.checks import one_line  # here: an answer to --help must not wait for NumPy

    return typer.BadParameter(f"found {one_line(repr(text))}, allowed: {allowed}")


def _are_whole(parts: list[str]) -> bool:
    """Whether all are whole numbers; Python refuses to read those with thousands of digits, in its own words."""
    return all(part.isascii() and part.isdigit() and len(part) <= _MOST_DIGITS for part in parts)


def _numbers(text: str, count: int, example: str) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) != count or any(v != v or abs(v) == float("inf") for v in values):
        raise refused(text, f"{count} numbers, such as {example}")
    return values


def vector(text: str) -> Vector:
    """X,Y,Z."""
    x, y, z = _numbers(text, 3, "1.0,-2.5,0.3")
    return x, y, z


def pair(text: str) -> tuple[float, float]:
    """W,H in world units."""
    w, h = _numbers(text, 2, "0.1,0.1")
    return w, h


def place(text: str) -> tuple[float, float]:
    """X,Y of an object."""
    x, y = _numbers(text, 2, "0.3,-0.2")
    return x, y


def law(text: str) -> tuple[float, float, float, float]:
    """A,B,C,D of a splat law."""
    a, b, c, d = _numbers(text, 4, "1,0,0.002,0.7")
    return a, b, c, d


def numbers(text: str) -> list[int]:
    """I,J,..: numbers of cameras."""
    parts = text.split(",")
    if not _are_whole(parts):
        raise refused(text, "numbers of cameras, such as 0 or 0,1")
    return [int(part) for part in parts]


def view(text: str) -> tuple[int, int | None, float]:
    """I, I:J or I:J:F: one camera, or two and how far it is from the first to the second."""
    first, *rest = text.split(":")
    fraction = rest[1] if len(rest) == 2 else "0.5"
    try:
        if len(rest) > 2 or not _are_whole([first, *rest[:1]]):
            raise ValueError
        where = float(fraction)
        if not 0.0 <= where <= 1.0:
            raise ValueError
    except ValueError:
        allowed = "a camera, such as 1, or two and a fraction in [0, 1], such as 0:1 or 0:1:0.25"
        raise refused(text, allowed) from None
    return int(first), int(rest[0]) if rest else None, where


def size(text: str) -> tuple[int, int]:
    """WIDTHxHEIGHT in pixels."""
    parts = text.lower().split("x")
    if len(parts) != 2 or not _are_whole(parts):
        raise refused(text, "WIDTHxHEIGHT in pixels, such as 640x480")
    width, height = int(parts[0]), int(parts[1])
    if not (1 <= width <= 65536 and 1 <= height <= 65536 and width * height <= 2**28):
        raise refused(text, "sides from 1 to 65536, at most 2^28 pixels")
    return width, height
