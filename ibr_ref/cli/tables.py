"""Tables that lose nothing: as wide as they need in a pipe, folded between words on a terminal, or else as a list."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

_WIDEST = 100_000
"""Columns of a pipe: any table fits."""


def counted(count: int, thing: str) -> str:
    """As in 1 case, 2 cases."""
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def show(table: Table, *, error: bool = False) -> None:
    """Print a table on standard output, or on standard error."""
    from rich.console import Console
    from rich.measure import Measurement

    console = Console(stderr=error)
    if not console.is_terminal:
        console = Console(stderr=error, width=_WIDEST)
    if Measurement.get(console, console.options.update(width=_WIDEST), table).minimum <= console.width:
        console.print(table)
    else:
        _as_list(console, table)


def _as_list(console: Console, table: Table) -> None:
    """Each row as lines of "column: cell", the first one outstanding."""
    cells = [list(column.cells) for column in table.columns]
    lines = [
        f"{'' if i == 0 else '  '}{column.header}: {column_cells[row]}"
        for row in range(table.row_count)
        for i, (column, column_cells) in enumerate(zip(table.columns, cells, strict=True))
        if column_cells[row]
    ]
    for text in (table.title, *lines, table.caption):
        if text:
            console.print(text, overflow="fold", highlight=False)
