"""Progress on a terminal; nothing in a pipe."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol


class Step(Protocol):
    """What a task calls before each of its steps."""

    def __call__(self, description: str) -> None:
        """Name the step that begins."""


@contextmanager
def progress(steps: int) -> Iterator[Step]:
    """Show a bar of `steps` steps and, while kernels are compiled (a first run), a second one that says how far that is."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from ibr_ref import jit

    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, disable=not console.is_terminal, transient=True) as bars:
        work = bars.add_task("starting", total=steps)
        compiling = bars.add_task("compiling kernels (first run)", total=None, visible=False)
        begun: set[str] = set()

        def compiles(name: str) -> None:
            begun.add(name)
            bars.update(
                compiling,
                visible=True,
                total=len(jit.functions),
                completed=len(begun),
                description=f"compiling kernels (first run): {name}",
            )

        started = 0

        def step(description: str) -> None:
            nonlocal started
            bars.update(work, description=description, completed=started)
            bars.update(compiling, visible=False)
            started += 1

        with jit.compilations(compiles):
            yield step
