"""The page itself."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from functools import cache
from importlib.resources import files
from itertools import groupby
from os import PathLike
from typing import Any

from jinja2 import Environment, StrictUndefined, Template

from ibr_ref.io.outputs import atomic
from ibr_ref.oracle.examination import Examination
from ibr_ref.oracle.findings import TraceStep
from ibr_ref.oracle.report import pictures
from ibr_ref.oracle.report.numbers import packed
from ibr_ref.oracle.report.shift import shift
from ibr_ref.oracle.words import MOST_LINES, words

MOST_CHARACTERS = 2_900_000
"""Of the pictures and the inspector's numbers; pictures come first."""
LEAST_NUMBERS = 300_000
"""Of the numbers, however large the pictures are."""

FOLDED = 4
"""Rows in a row of which reference and port have the same: from so many on they are folded."""


def write(examination: Examination, path: str | PathLike[str]) -> None:
    """Write the page, whole or not at all. Raises OSError with the path."""
    text = page(examination)
    with atomic(path) as file:
        file.write(text.encode("utf-8"))


def page(examination: Examination) -> str:
    """The page as text."""
    verdict = examination.verdict
    height, width = examination.case.frame.color.shape[:2]
    data = _data(examination)
    return template("page.html").render(
        verdict=verdict,
        words=words(verdict, trace=False),  # which have tables of their own
        most_lines=MOST_LINES,
        folded=folded,
        about=examination.case.about,
        compared=data["port"] is not None,
        shift=shift(examination),
        stages=_stages(examination),
        width=width,
        height=height,
        start=_start(examination),
        style=asset("page.css"),
        script=asset("page.js"),
        data=script_safe(data),
    )


@cache
def template(name: str) -> Template:
    """Compiled once: it takes longer than all else that is done for a small page."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(asset(name))


def asset(name: str) -> str:
    """A file of this folder."""
    return files("ibr_ref.oracle.report").joinpath(name).read_text("utf-8")


def folded(trace: Sequence[TraceStep]) -> Iterator[tuple[bool, list[TraceStep]]]:
    """The rows in groups: (whether it is folded, its rows)."""
    for same, group in groupby(trace, lambda step: bool(step.port) and step.port == step.reference):
        rows = list(group)
        yield same and len(rows) >= FOLDED, rows


def _stages(examination: Examination) -> list[tuple[str, str]]:
    """(name, address of a picture) of each wrong stage that has places in two dimensions."""
    wrong = [j for j in examination.judgements if j.stage != "image" and j.wrong.any()]
    found = ((judgement.stage, pictures.stage_address(judgement)) for judgement in wrong)
    return [(stage, address) for stage, address in found if address is not None]


def _start(examination: Examination) -> tuple[int, int]:
    """The pixel (x, y) that the inspector shows at first: the first witness that is one, else the middle."""
    height, width = examination.case.frame.color.shape[:2]
    for witness in examination.verdict.witnesses:
        if witness.element == "pixel":  # of several light samples the sample comes first
            row, column = witness.index[-2:]
            return column, row
    return width // 2, height // 2


def _data(examination: Examination) -> dict[str, Any]:
    """Pictures and numbers. The port's picture is what has to be added to the reference's, modulo 256."""
    reference, port = pictures.reference(examination), pictures.port(examination)
    status, moved = pictures.status(examination), shift(examination)
    found: dict[str, Any] = {
        "reference": pictures.address(reference),
        "port": None if port is None else pictures.address(port - reference),
        "status": None if status is None else pictures.address(status),
        "shift": None if moved is None else pictures.address(moved.picture),
    }
    used = sum(len(address) for address in found.values() if address is not None)
    return {**found, **packed(examination, max(MOST_CHARACTERS - used, LEAST_NUMBERS))}


def script_safe(data: Any) -> str:
    """JSON that cannot end the script element that it stands in."""
    return json.dumps(data).replace("<", "\\u003c")
