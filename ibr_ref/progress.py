"""Progress on a terminal; nothing in a pipe."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rich.progress import Progress

_COMPILING = "compiling kernels (first run)"


class Step(Protocol):
    """What a task calls before each of its steps."""

    def __call__(self, description: str) -> None:
        """Name the step that begins."""

    def within(self, description: str, done: int, total: int) -> None:
        """Say how far a long step is."""


class _Bars:
    """The bars of one task: its steps, and how far the step is."""

    def __init__(self, bars: Progress, steps: int) -> None:
        self.bars = bars
        self.work = bars.add_task("starting", total=steps)
        self.part = bars.add_task("", total=None, visible=False)
        self.compiling = bars.add_task(_COMPILING, total=None, visible=False)
        self.begun: set[str] = set()
        self.started = 0

    def compiles(self, name: str) -> None:
        from ibr_ref import jit

        self.begun.add(name)
        total, description = len(jit.functions), f"{_COMPILING}: {name}"
        self.bars.update(self.compiling, visible=True, total=total, completed=len(self.begun), description=description)

    def __call__(self, description: str) -> None:
        self.bars.update(self.work, description=description, completed=self.started)
        for bar in (self.part, self.compiling):
            self.bars.update(bar, visible=False)
        self.started += 1

    def within(self, description: str, done: int, total: int) -> None:
        self.bars.update(self.part, visible=True, description=description, completed=done, total=total)


class _Silent:
    """Of what is no terminal."""

    def __call__(self, description: str) -> None:
        pass

    def within(self, description: str, done: int, total: int) -> None:
        pass


@contextmanager
def progress(steps: int) -> Iterator[Step]:
    """Show a bar of `steps` steps and, while kernels are compiled (a first run), another one that says how far that is."""
    if not (sys.stderr.isatty() or os.environ.get("FORCE_COLOR")):
        yield _Silent()  # and whoever reads a pipe need not wait for Rich
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from ibr_ref import jit

    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, disable=not console.is_terminal, transient=True) as bars:
        step = _Bars(bars, steps)
        with jit.compilations(step.compiles):
            yield step
