"""`ibr-ref hunt`: a port's bugs, found with random cases."""

from __future__ import annotations

import time
from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ibr_ref import methods
from ibr_ref.cli import options
from ibr_ref.cli.groups import grouped
from ibr_ref.cli.hunt_folder import Folder, State
from ibr_ref.cli.tables import counted
from ibr_ref.oracle.device import PROFILES
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.progress import Step
    from ibr_ref.testing import Drawer, Found, Hunt

EXAMPLES = """
Examples:

    ibr-ref hunt --port "./my_port {case} {out}"

    ibr-ref hunt --port "./my_port {case} {out}" --method displacement --device vulkan --seconds 60 --out bugs

    ibr-ref hunt --port ./my_port --serve

    ibr-ref hunt --page

    ibr-ref check bugs/cases bugs/drawn

Exit code 0: no bug is known in DIR, 1: some are, 2: an option or the port is unusable.
"""


@dataclass(frozen=True, kw_only=True)
class Ported:
    """Options: the port."""

    port: Annotated[
        str | None,
        typer.Option(
            help="Command with {case} and {out}: the folder that it reads, as `ibr-ref export` writes it, and "
            "the one that it writes to."
        ),
    ] = None
    serve: Annotated[
        bool,
        typer.Option(
            "--serve",
            help="The command is started once, and told CASE, a tab and OUT on a line each time; it answers ok on a line, "
            "or why not.",
        ),
    ] = False
    page: Annotated[
        bool,
        typer.Option(
            "--page", help="The port is a page, of WebGL or WebGPU: print the address of a module that it imports."
        ),
    ] = False


@dataclass(frozen=True, kw_only=True)
class Search:
    """Options: what is looked for, for how long, and where it is kept."""

    method: Annotated[str | None, typer.Option(help=f"{' or '.join(methods.names())}. Without: all in turn.")] = None
    system: Annotated[
        str | None,
        typer.Option(
            help="With --method, the one that the port draws: a search of displacement mapping (without: protruded), "
            "square or disc, warp or direct (without: both)."
        ),
    ] = None
    seconds: Annotated[
        float,
        typer.Option(
            parser=options.number, help="How long new bugs are looked for; one more may be made smaller then."
        ),
    ] = 300.0
    seed: Annotated[int, typer.Option(parser=options.whole, help="Of the random cases.")] = 0
    out: Annotated[
        Path,
        typer.Option(
            help="Folder for cases/, drawn/ and reports/ of what is found; a hunt that has one goes on there."
        ),
    ] = Path("hunt")
    device: Annotated[
        str | None,
        typer.Option(
            help=f"Profile that the port declares: {', '.join(PROFILES)}. Without: port.json's, or the loosest."
        ),
    ] = None


@grouped
def command(ported: Ported, search: Search) -> None:
    """Look for a port's bugs with random cases, and make the first failure of each as small as it gets.

    A bug is the first wrong stage, the first of its arrays that disagrees, and where known bugs explain it, these. Found
    ones are skipped from then on, until the port is right on their cases: those are drawn first when a hunt goes on.
    """
    wanted = _checked(search)
    folder = Folder(search.out)
    state = folder.state()
    drawer = _drawer(ported)
    started = time.monotonic()
    with progress(1) as step, closing(drawer):
        step("hunting")
        mended = {bug for bug in state.bugs if folder.is_mended(bug, drawer, search.device)}
        for bug in sorted(mended):
            typer.echo(f"mended: {bug.name}")
        before = {*state.bugs} - mended
        hunt = _hunt(search, wanted, drawer, folder.place, State((*before,), state.rounds))
        hunt.told = partial(_say_how_far, step, started, search.seconds)
        for found in _kept(hunt, search.seconds, folder):
            typer.echo(_line(found, folder.keep(found, drawer, search.device)))
    typer.echo(
        f"{counted(hunt.tried, 'case')} in {time.monotonic() - started:.0f} s (seed {search.seed}, rounds {state.rounds} to "
        f"{hunt.rounds}): {counted(len(hunt.known) - len(before), 'new bug')}, {len(before)} known from before."
    )
    raise typer.Exit(1 if hunt.known else 0)


def _checked(search: Search) -> tuple[str, ...]:
    """The methods. Raises ValueError for what cannot be used, and where Hypothesis is missing."""
    try:
        import hypothesis  # noqa: F401
    except ImportError:
        raise ValueError('hunt needs Hypothesis, which is not installed: pip install "ibr_ref[hypothesis]"') from None
    from ibr_ref.scene import checks

    method, system = search.method, search.system
    if method is not None:
        checks.choice("method", method, methods.names())
    if system is not None:
        if method is None:
            raise typer.BadParameter("found no method, allowed with --system: --method METHOD")
        checks.choice("system", system, methods.named(method).judged[1])
    if search.device is not None:
        checks.choice("device", search.device, tuple(PROFILES))
    checks.number("seconds", search.seconds, above=0.0)
    return methods.names() if method is None else (method,)


def _drawer(ported: Ported) -> Drawer:
    """The port, which may have to be opened first: where is printed. Raises ValueError for what is none."""
    from ibr_ref.testing import Door, Program, Served

    if ported.page:
        door = Door()
        typer.echo(f"{door.address}port.js")
        return door
    if ported.port is None:
        raise typer.BadParameter("found no port, allowed: --port COMMAND, or --page")
    return Served(ported.port) if ported.serve else Program(ported.port)


def _hunt(search: Search, wanted: tuple[str, ...], drawer: Drawer, place: Path, state: State) -> Hunt:
    """The hunt that goes on from a state, in a folder."""
    from ibr_ref.testing import Hunt, port_of

    return Hunt(
        port=partial(port_of, drawer), methods=wanted, system=search.system, device=search.device, seed=search.seed,
        database=place / "examples", known={*state.bugs}, rounds=state.rounds,
    )  # fmt: skip


def _say_how_far(step: Step, started: float, seconds: float, hunt: Hunt) -> None:
    """On the line of the progress."""
    passed = min(time.monotonic() - started, seconds)
    step.within(f"{hunt.tried} cases, {len(hunt.known)} bugs", int(passed), int(seconds))


def _kept(hunt: Hunt, seconds: float, folder: Folder) -> Iterable[Found]:
    """What it finds; how far it has come is written down after each, and at the end, however that comes."""
    try:
        for found in hunt.run(seconds):
            yield found
            folder.note(hunt)
    finally:
        folder.note(hunt)


def _line(found: Found, verdict: str) -> str:
    camera, causes = found.case.scene.camera, found.bug.causes
    why = f" Explained by {' or '.join(causes)}." if causes else ""
    return f"{verdict}{why} {camera.width} x {camera.height} pixels, after {counted(found.after, 'case')}."
