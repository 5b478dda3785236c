"""What the sweeps of all methods share: their options, the run, and what is printed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli import options
from ibr_ref.cli.sweeps import values
from ibr_ref.cli.what_goes_with_what import ABSENT, Beside, always
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.sweep import Sweep

Views = Annotated[int, typer.Option(parser=options.whole, help="How many views, from around the scene.")]
Places = Annotated[int, typer.Option("--views", parser=options.whole, help="How many places of the caster.")]
Size = Annotated[options.Size, typer.Option(parser=options.size, metavar="WxH", help="Pixels of a picture.")]

SMALL = options.Size(320, 240)

_MOST_LINES = 30
"""Of the frontier that are printed."""


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """Options: what is swept over, what is looked for, and who draws."""

    over: Annotated[
        list[values.Over],
        typer.Option(
            "--over",
            parser=values.over,
            metavar="NAME=VALUES",
            help="A parameter, called as the field of Params or the option of `ibr-ref render`, and its values: A,B,.. or "
            "FROM:TO:STEP. Once for each; a single value holds it fixed.",
        ),
    ]
    out: Annotated[
        Path | None,
        typer.Option(
            help="The table, as Parquet. A sweep that was interrupted goes on from it; more values add to it."
        ),
    ] = None
    plot: Annotated[Path | None, typer.Option(help="Error against cost of all settings, as PNG.")] = None
    bound: Annotated[
        values.Bound | None,
        typer.Option(
            parser=values.bound,
            metavar="MEASURE=NUMBER",
            help="Name the cheapest setting that meets this in every view.",
        ),
    ] = None
    cost: Annotated[str | None, typer.Option(help="The measure that settings should have little of.")] = None
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Of a Dask scheduler. Without: a cluster of this machine.")
    ] = None
    workers: Annotated[
        int | None,
        typer.Option(
            parser=options.whole,
            help="Processes of this machine. Without: one a processor; 0: this process, without Dask.",
        ),
    ] = None


def run(method: str, wanted: Wanted, views: int, make: Callable[[], tuple[Any, Any]]) -> None:
    """Sweep over what `make` gives, a scene and what it is measured against, and print what was found."""
    with progress(3) as step:
        step("reading the scene")
        from ibr_ref import io
        from ibr_ref.sweep import measures, sweep

        known = measures(method)
        for flag, name in (("--bound", wanted.bound and wanted.bound.name), ("--cost", wanted.cost)):
            if name is not None and name not in known:
                raise typer.BadParameter(f"{flag}: found {name}, allowed: {' | '.join(known)}")
        names = [each.name for each in wanted.over]
        for name in names:
            if names.count(name) > 1:
                raise typer.BadParameter(
                    f"--over: found {name} {names.count(name)} times, allowed: once, with all values"
                )
        if wanted.plot is not None:
            io.check_writable(wanted.plot)
        scene, against = make()
        step("sweeping")
        found = sweep(
            method,
            scene,
            over={each.name: each.values for each in wanted.over},
            views=views,
            against=against,
            out=wanted.out,
            scheduler=wanted.scheduler,
            workers=wanted.workers,
            progress=step.within,
        ).by(error=wanted.bound and wanted.bound.name, cost=wanted.cost)
        step("plotting")
        if wanted.plot is not None:
            found.plot(wanted.plot, wanted.bound and wanted.bound.value)
    _show(found, wanted.bound)


def _show(found: Sweep, bound: values.Bound | None) -> None:
    from rich.table import Table

    from ibr_ref.cli.tables import show

    frontier, names = found.frontier, list(found.settings[0])
    title = f"{found.method}: {found.error}, worst view, against {found.cost}; {len(found.table):,} rows"
    table = Table(title=title, caption=_left_out(len(frontier)))
    for name in (*names, found.error, found.cost):
        table.add_column(name, justify="right")
    for each in frontier[:_MOST_LINES]:
        cells = (*each.setting.values(), each.error, each.cost)
        table.add_row(*(f"{cell:.6g}" if isinstance(cell, float) else str(cell) for cell in cells))
    show(table)
    if bound is None:
        return
    chosen, sign = found.smallest(bound.value), ">=" if found.measures[bound.name].more else "<="
    if chosen is None:
        best = f"; the best one reaches {frontier[-1].error:.6g}" if frontier else ""
        typer.echo(f"no setting has {bound.name} {sign} {bound.value:g} in every view{best}")
    else:
        typer.echo(
            f"{bound.name} {sign} {bound.value:g} in every view: {chosen} ({bound.name} {chosen.error:.6g}, {found.cost} "
            f"{chosen.cost:.6g})"
        )


def _left_out(count: int) -> str | None:
    return f"{count - _MOST_LINES} more" if count > _MOST_LINES else None


def goes_with() -> dict[str, Beside]:
    """Beside which others the options are read that all have."""
    return {
        **always("over", "views", "against", "out", "plot", "bound", "cost", "scheduler", "size"),
        "workers": Beside("the scheduler has its own", {"scheduler": ABSENT}),
    }
