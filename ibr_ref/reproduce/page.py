"""A paper's page: self-contained HTML, and the same as JSON."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from jinja2 import Environment, StrictUndefined
from pydantic import BaseModel, ConfigDict

from ibr_ref.io.outputs import atomic
from ibr_ref.reproduce.findings import Cell, Found, Reproduction, Step


class _Page(BaseModel):
    """What the JSON holds."""

    model_config = ConfigDict(frozen=True)

    paper: str
    method: str
    steps: dict[str, Found]
    ambiguities: tuple[tuple[str, str], ...]


def write_page(reproduction: Reproduction, results: Sequence[tuple[Step, Found]], folder: Path) -> Path:
    """Write `page.html` and `page.json` into the folder; the page's path."""
    whole = _Page(
        paper=reproduction.paper,
        method=reproduction.method,
        steps={step.name: found for step, found in results},
        ambiguities=reproduction.ambiguities,
    )
    with atomic(folder / "page.json") as file:
        file.write(whole.model_dump_json(indent=2).encode("utf-8") + b"\n")
    text = _html(reproduction, results, folder)
    with atomic(folder / "page.html") as file:
        file.write(text.encode("utf-8"))
    return folder / "page.html"


def _html(reproduction: Reproduction, results: Sequence[tuple[Step, Found]], folder: Path) -> str:
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["cell"] = _cell
    return environment.from_string(files("ibr_ref.reproduce").joinpath("page.html").read_text("utf-8")).render(
        reproduction=reproduction,
        results=results,
        claims=[claim for _, found in results for claim in found.claims],
        sources={
            (step.name, figure.file): _address(folder / step.name / figure.file)
            for step, found in results
            for figure in found.figures
        },
    )


def _address(path: Path) -> str:
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def _cell(value: Cell) -> str:
    """A number with four significant digits, a dash for what does not exist."""
    if value is None:
        return "–"
    if isinstance(value, int):
        return f"{value:,}"
    return f"{value:,.4g}" if isinstance(value, float) else value
