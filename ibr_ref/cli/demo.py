"""`ibr-ref demo`: the papers' figures from built-in inputs."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref import methods
from ibr_ref.cli.tables import show
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.demo.picture import Picture

EXAMPLES = """
Example:

    ibr-ref demo --out demo
"""


def command(
    out: Annotated[Path, typer.Option(help="Folder for the pictures; made if it is not there.")] = Path("demo"),
) -> None:
    """Render the papers' figures from built-in inputs: pictures, a contact sheet, and times beside the papers'."""
    from ibr_ref.io.outputs import make_folder

    make_folder(out)
    demos = {method: method.demo.open() for method in methods.records() if method.demo is not None}
    shown: list[tuple[str, Any]] = []
    rows: dict[methods.Method, list[tuple[Picture, float | None]]] = {method: [] for method in demos}
    with progress(sum(demo.PICTURES for demo in demos.values()) + 1) as step:
        for method, demo in demos.items():
            for picture in demo.pictures():
                step(picture.caption)
                color = picture.draw()
                _save(out / f"{picture.name}.png", color)
                shown.append((picture.caption, color))
                rows[method].append((picture, _milliseconds(picture)))
        step("contact sheet")
        from ibr_ref.demo.contact_sheet import contact_sheet

        _save(out / "contact_sheet.png", contact_sheet(shown, columns=3))
    for method, demo in demos.items():
        show(_table(f"{method.title} ({method.source}), {demo.SIZES}", demo.NOTE, rows[method]))
    typer.echo(f"{len(shown)} pictures and contact_sheet.png are in {out}{'' if str(out).endswith('/') else '/'}")


def _save(path: Path, color: Any) -> None:
    from ibr_ref.io import write_image

    write_image(path, color)


def _milliseconds(picture: Picture) -> float | None:
    """Of a second, warm rendering of its frame."""
    if picture.frame is None:
        return None
    picture.frame()
    start = time.perf_counter()
    picture.frame()
    return 1e3 * (time.perf_counter() - start)


def _table(title: str, note: str, rows: list[tuple[Picture, float | None]]) -> Any:
    from rich.table import Table

    table = Table(title=title, caption=note)
    for column in ("figure", "settings", "this machine, ms", "paper, ms"):
        table.add_column(column, justify="right" if column.endswith("ms") else "left")
    for picture, taken in rows:
        table.add_row(picture.caption, picture.settings, "" if taken is None else f"{taken:.1f}", picture.paper_ms)
    return table
