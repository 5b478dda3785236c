"""The page itself."""

from __future__ import annotations

import base64
import json
import zlib
from functools import cache
from importlib.resources import files
from os import PathLike
from typing import Any

import numpy as np
from jinja2 import Environment, StrictUndefined, Template
from numpy.typing import NDArray

from ibr_ref.io.outputs import atomic
from ibr_ref.oracle.examination import Examination
from ibr_ref.oracle.report.layers import blamed, layers, planes, stage_layer
from ibr_ref.oracle.words import MOST_LINES, words

MOST_BYTES = 96 * 2**20
"""Of the inspector's numbers before they are packed: what a browser holds with ease. Stages beyond it are left out."""


def write(examination: Examination, path: str | PathLike[str]) -> None:
    """Write the page, whole or not at all. Raises OSError with the path."""
    text = page(examination)
    with atomic(path) as file:
        file.write(text.encode("utf-8"))


def page(examination: Examination) -> str:
    """The page as text."""
    verdict = examination.verdict
    first = examination.first_wrong
    pictures = layers(examination)
    height, width = examination.case.frame.color.shape[:2]
    return _template().render(
        verdict=verdict,
        words=words(verdict, trace=False),  # which have tables of their own
        most_lines=MOST_LINES,
        about=examination.case.about,
        layers=pictures,
        compared=len(pictures) > 1,
        stage=None if first is None or first.stage == "image" else stage_layer(first),
        width=width,
        height=height,
        start=_start(examination),
        style=_asset("page.css"),
        script=_asset("page.js"),
        data=_script_safe(_inspector(examination)),
    )


@cache
def _template() -> Template:
    """Compiled once: it takes longer than all else that is done for a small page."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(_asset("page.html"))


def _asset(name: str) -> str:
    return files("ibr_ref.oracle.report").joinpath(name).read_text("utf-8")


def _start(examination: Examination) -> tuple[int, int]:
    """The pixel (x, y) that the inspector shows at first: the first witness that is one, else the middle."""
    height, width = examination.case.frame.color.shape[:2]
    for witness in examination.verdict.witnesses:
        if witness.element == "pixel":  # of several light samples the sample comes first
            row, column = witness.index[-2:]
            return column, row
    return width // 2, height // 2


def _inspector(examination: Examination) -> dict[str, Any]:
    """Everything that is shown of a pixel, as packed arrays."""
    image = examination.judgement("image")
    arrays, room = [], MOST_BYTES
    for name, pair in planes(examination).items():
        packed = [None if array is None else _pack(array) for array in (*pair, blamed(examination, name))]
        room -= sum(p["bytes"] for p in packed if p is not None)
        if room < 0:
            break
        arrays.append({"name": name, "reference": packed[0], "port": packed[1], "wrong": packed[2]})
    status = None
    if image is not None:
        status = _pack((image.undecided + 2 * image.wrong).astype(np.int32))
    return {"arrays": arrays, "status": status}


def _pack(array: NDArray[np.generic]) -> dict[str, Any]:
    """Little-endian float32 or int32 numbers, deflated, in base64."""
    integers = array.dtype.kind in "biu"
    numbers = np.ascontiguousarray(array, "<i4" if integers else "<f4")
    return {
        "kind": "int" if integers else "float",
        "channels": int(np.prod(array.shape[2:], dtype=int)),
        "bytes": numbers.nbytes,
        "data": base64.b64encode(zlib.compress(numbers.tobytes(), 6)).decode("ascii"),
    }


def _script_safe(data: dict[str, Any]) -> str:
    """JSON that cannot end the script element that it stands in."""
    return json.dumps(data).replace("<", "\\u003c")
