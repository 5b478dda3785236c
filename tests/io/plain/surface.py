"""What the plain readers give."""

from __future__ import annotations

import math
import re

Corner = tuple[float, ...]
Surface = list[list[Corner]]

NO_COLOR = (0.8, 0.8, 0.8)

_NUMBER = re.compile(rb"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
_WHOLE = re.compile(rb"[+-]?[0-9]+")


class Refused(Exception):  # noqa: N818
    """The file is no mesh that triangles can stand for."""


def number(word: bytes) -> float:
    if not _NUMBER.fullmatch(word):
        raise Refused(f"{word!r} is no number")
    return float(word)


def whole(word: bytes) -> int:
    if not _WHOLE.fullmatch(word):
        raise Refused(f"{word!r} is no whole number")
    return int(word)


def need(condition: object, what: str = "not allowed") -> None:
    if not condition:
        raise Refused(what)


def assembled(points: list[Corner], colors: list[Corner] | None, polygons: list[list[int]]) -> Surface:
    """Polygons of corners with colours."""
    need(all(math.isfinite(x) for p in points for x in p), "not finite")
    if colors is not None:
        need(all(0.0 <= c <= 1.0 for color in colors for c in color), "colour")
        need(len(colors) == len(points), "as many colours as vertices")
    for polygon in polygons:
        need(len(polygon) >= 3 and all(0 <= i < len(points) for i in polygon), "corner")
    return [[(*points[i], *(NO_COLOR if colors is None else colors[i])) for i in polygon] for polygon in polygons]
