"""`ibr-ref demo`: the papers' figures from built-in inputs."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli.tables import show
from ibr_ref.demo import displacement, shadows, splatting
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.demo.picture import Picture

EXAMPLES = """
Example:

    ibr-ref demo --out demo
"""

METHODS = (displacement, splatting, shadows)


def command(
    out: Annotated[Path, typer.Option(help="Folder for the pictures; made if it is not there.")] = Path("demo"),
) -> None:
    """Render the papers' figures from built-in inputs: pictures, a contact sheet, and times beside the papers'."""
    from ibr_ref.io.outputs import make_folder

    make_folder(out)
    shown, rows = [], []
    with progress(sum(method.PICTURES for method in METHODS) + 1) as step:
        for method in METHODS:
            for picture in method.pictures():
                step(picture.caption)
                color = picture.draw()
                _save(out / f"{picture.name}.png", color)
                shown.append((picture.caption, color))
                rows.append((method.TITLE, picture, _milliseconds(picture)))
        step("contact sheet")
        from ibr_ref.demo.contact_sheet import contact_sheet

        _save(out / "contact_sheet.png", contact_sheet(shown, columns=3))
    for method in METHODS:
        show(_table(method.TITLE, method.NOTE, [row[1:] for row in rows if row[0] == method.TITLE]))
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
