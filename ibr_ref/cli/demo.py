"""`ibr-ref demo`: the papers' figures from built-in inputs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref import methods
from ibr_ref.cli.tables import show
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

    from ibr_ref.demo.drawing import Drawn
    from ibr_ref.progress import Step

EXAMPLES = """
Example:

    ibr-ref demo --out demo
"""

Rows = dict[methods.Method, list["Drawn"]]


def command(
    out: Annotated[Path, typer.Option(help="Folder for the pictures; made if it is not there.")] = Path("demo"),
) -> None:
    """Render the papers' figures from built-in inputs: pictures, a contact sheet, and times beside the papers'.

    Each method draws in a process of its own, so that a first run compiles on two processors.
    """
    from ibr_ref.io.outputs import make_folder

    make_folder(out)
    demos = {method: method.demo.open() for method in methods.records() if method.demo is not None}
    with progress(sum(demo.PICTURES for demo in demos.values()) + 1) as step:
        rows, times = _drawn(list(demos), out, step)
        step("contact sheet")
        from ibr_ref.demo.contact_sheet import contact_sheet
        from ibr_ref.io import write_image

        shown = [(picture.caption, picture.color) for method in demos for picture in rows[method]]
        write_image(out / "contact_sheet.png", contact_sheet(shown, columns=3))
    for method, demo in demos.items():
        show(_table(f"{method.title} ({method.source}), {demo.SIZES}", demo.NOTE, rows[method], times[method]))
    typer.echo(f"{len(shown)} pictures and contact_sheet.png are in {out}{'' if str(out).endswith('/') else '/'}")


def _drawn(
    wanted: list[methods.Method], out: Path, step: Step
) -> tuple[Rows, dict[methods.Method, list[float | None]]]:
    """The pictures of all methods, drawn side by side, and then their times, one method after another."""
    from multiprocessing import get_context

    from ibr_ref.demo import drawing

    context = get_context("spawn")  # a fork would copy threads that Numba may have started
    heard: dict[Connection, methods.Method] = {}
    processes = []
    try:
        for method in wanted:
            here, there = context.Pipe()
            processes.append(context.Process(target=drawing.draw, args=(method, out, there), daemon=True))
            processes[-1].start()
            there.close()
            heard[here] = method
        rows = _collected(heard, step)
        times = {method: _asked(connection) for connection, method in heard.items()}
        for process in processes:
            process.join()
    finally:
        for process in processes:
            process.terminate()
    return rows, times


def _collected(heard: dict[Connection, methods.Method], step: Step) -> Rows:
    """Pictures as they come, until every method has drawn its own."""
    from multiprocessing.connection import wait

    from ibr_ref.demo.drawing import Compiling, Drawn, Finished

    rows: Rows = {method: [] for method in heard.values()}
    waiting, kernels = dict(heard), 0
    while waiting:
        for connection in wait(list(waiting)):
            said = _received(connection)  # type: ignore[arg-type]
            method = heard[connection]  # type: ignore[index]
            if isinstance(said, Compiling):
                kernels += 1
                step.within(f"compiling kernels (first run): {method.name}: {said.name}", kernels, kernels)
            elif isinstance(said, Drawn):
                rows[method].append(said)
                step(said.caption)
            elif isinstance(said, Finished):
                del waiting[connection]  # type: ignore[arg-type]
    return rows


def _asked(connection: Connection) -> list[float | None]:
    """A method's times."""
    connection.send("times")
    times: list[float | None] = _received(connection)
    return times


def _received(connection: Connection) -> Any:
    """What a process says; raises the error that it met, or OSError where it has died."""
    try:
        said = connection.recv()
    except EOFError:
        raise OSError("a process that draws died: out of memory, perhaps") from None
    if isinstance(said, Exception):
        raise said
    return said


def _table(title: str, note: str, rows: list[Drawn], times: list[float | None]) -> Any:
    from rich.table import Table

    table = Table(title=title, caption=note)
    for column in ("figure", "settings", "this machine, ms", "paper, ms"):
        table.add_column(column, justify="right" if column.endswith("ms") else "left")
    for picture, taken in zip(rows, times, strict=True):
        table.add_row(picture.caption, picture.settings, "" if taken is None else f"{taken:.1f}", picture.paper_ms)
    return table
