"""`ibr-ref hunt`: a port's bugs, found with random cases."""

from __future__ import annotations

import json
import time
from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref import methods
from ibr_ref.cli import options
from ibr_ref.cli.tables import counted
from ibr_ref.oracle.device import PROFILES
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref import oracle
    from ibr_ref.testing import Bug, Drawer, Found, Hunt

EXAMPLES = """
Examples:

    ibr-ref hunt --port "./my_port {case} {out}"

    ibr-ref hunt --port "./my_port {case} {out}" --method displacement --device vulkan --seconds 60 --out bugs

    ibr-ref hunt --port ./my_port --serve

    ibr-ref hunt --page

    ibr-ref check bugs/cases bugs/drawn

Exit code 0: no bug is known in DIR, 1: some are, 2: an option or the port is unusable.
"""

_STATE = "hunt.json"


def command(
    port: Annotated[
        str | None,
        typer.Option(
            help="Command with {case} and {out}: the folder that it reads, as `ibr-ref export` writes it, and "
            "the one that it writes to."
        ),
    ] = None,
    serve: Annotated[
        bool,
        typer.Option(
            "--serve",
            help="The command is started once, and told CASE, a tab and OUT on a line each time; it answers ok on a line, "
            "or why not.",
        ),
    ] = False,
    page: Annotated[
        bool,
        typer.Option(
            "--page", help="The port is a page, of WebGL or WebGPU: print the address of a module that it imports."
        ),
    ] = False,
    method: Annotated[str | None, typer.Option(help=f"{' or '.join(methods.names())}. Without: all in turn.")] = None,
    system: Annotated[
        str | None,
        typer.Option(
            help="With --method, the one that the port draws: a search of displacement mapping (without: protruded), "
            "square or disc, warp or direct (without: both)."
        ),
    ] = None,
    seconds: Annotated[
        float,
        typer.Option(
            parser=options.number, help="How long new bugs are looked for; one more may be made smaller then."
        ),
    ] = 300.0,
    seed: Annotated[int, typer.Option(parser=options.whole, help="Of the random cases.")] = 0,
    out: Annotated[
        Path,
        typer.Option(
            help="Folder for cases/, drawn/ and reports/ of what is found; a hunt that has one goes on there."
        ),
    ] = Path("hunt"),
    device: Annotated[
        str | None,
        typer.Option(
            help=f"Profile that the port declares: {', '.join(PROFILES)}. Without: port.json's, or the loosest."
        ),
    ] = None,
) -> None:
    """Look for a port's bugs with random cases, and make the first failure of each as small as it gets.

    A bug is the first wrong stage, the first of its arrays that disagrees, and where known bugs explain it, these. Found
    ones are skipped from then on, until the port is right on their cases: those are drawn first when a hunt goes on.
    """
    wanted = _checked(method, system, seconds, device)
    folder = _Folder(out)
    state = folder.state()
    drawer = _drawer(port, serve, page)
    started = time.monotonic()
    from ibr_ref.testing import Hunt, port_of

    with progress(1) as step, closing(drawer):
        step("hunting")
        mended = {bug for bug in state.bugs if folder.is_mended(bug, drawer, device)}
        for bug in sorted(mended):
            typer.echo(f"mended: {bug.name}")
        before = len(state.bugs) - len(mended)

        def told(hunt: Hunt) -> None:
            passed = min(time.monotonic() - started, seconds)
            step.within(f"{hunt.tried} cases, {len(hunt.known)} bugs", int(passed), int(seconds))

        hunt = Hunt(
            port=partial(port_of, drawer), methods=wanted, system=system, device=device, seed=seed,
            database=folder.place / "examples", known={*state.bugs} - mended, rounds=state.rounds, told=told,
        )  # fmt: skip
        for found in _kept(hunt, seconds, folder):
            typer.echo(_line(found, folder.keep(found, drawer, device)))
    new = len(hunt.known) - before
    typer.echo(
        f"{counted(hunt.tried, 'case')} in {time.monotonic() - started:.0f} s (seed {seed}, rounds {state.rounds} to "
        f"{hunt.rounds}): {counted(new, 'new bug')}, {before} known from before."
    )
    raise typer.Exit(1 if hunt.known else 0)


def _checked(method: str | None, system: str | None, seconds: float, device: str | None) -> tuple[str, ...]:
    """The methods. Raises ValueError for what cannot be used, and where Hypothesis is missing."""
    try:
        import hypothesis  # noqa: F401
    except ImportError:
        raise ValueError('hunt needs Hypothesis, which is not installed: pip install "ibr_ref[hypothesis]"') from None
    from ibr_ref.scene import checks

    if method is not None:
        checks.choice("method", method, methods.names())
    if system is not None:
        if method is None:
            raise typer.BadParameter("found no method, allowed with --system: --method METHOD")
        checks.choice("system", system, methods.named(method).judged[1])
    if device is not None:
        checks.choice("device", device, tuple(PROFILES))
    checks.number("seconds", seconds, above=0.0)
    return methods.names() if method is None else (method,)


def _drawer(port: str | None, serve: bool, page: bool) -> Drawer:
    """The port, which may have to be opened first: where is printed. Raises ValueError for what is none."""
    from ibr_ref.testing import Door, Program, Served

    if page:
        door = Door()
        typer.echo(f"{door.address}port.js")
        return door
    if port is None:
        raise typer.BadParameter("found no port, allowed: --port COMMAND, or --page")
    return Served(port) if serve else Program(port)


def _kept(hunt: Hunt, seconds: float, folder: _Folder) -> Iterable[Found]:
    """What it finds; how far it has come is written down after each, and at the end, however that comes."""
    try:
        for found in hunt.run(seconds):
            yield found
            folder.note(hunt)
    finally:
        folder.note(hunt)


@dataclass(frozen=True)
class _State:
    """How far a hunt has come."""

    bugs: tuple[Bug, ...] = ()
    rounds: int = 0


@dataclass(frozen=True)
class _Folder:
    """Where a hunt keeps what it has found."""

    place: Path

    def state(self) -> _State:
        """Of the hunt before; makes the folder. Raises OSError and ValueError for one that is none of a hunt."""
        from ibr_ref.io.outputs import make_folder
        from ibr_ref.scene import checks
        from ibr_ref.testing import Bug

        make_folder(self.place)
        path = self.place / _STATE
        if not path.exists():
            if any(self.place.iterdir()):
                raise FileExistsError(
                    f"{checks.named(self.place)}: holds other things, allowed: a new folder, or a hunt's"
                )
            return _State()
        try:
            fields: dict[str, Any] = json.loads(path.read_bytes())
            bugs = tuple(
                Bug(str(bug["method"]), str(bug["stage"]), str(bug["array"]), tuple(map(str, bug["causes"])))
                for bug in fields["bugs"]
            )
            return _State(bugs, int(fields["rounds"]))
        except (ValueError, KeyError, TypeError):
            raise ValueError(f"{checks.named(path)}: found what no hunt wrote, allowed: a hunt's {_STATE}") from None

    def note(self, hunt: Hunt) -> None:
        """Write down what is known."""
        from ibr_ref.io.outputs import atomic

        bugs = [bug._asdict() for bug in sorted(hunt.known)]
        text = json.dumps({"seed": hunt.seed, "rounds": hunt.rounds, "bugs": bugs}, indent=1)
        with atomic(self.place / _STATE) as file:
            file.write(text.encode() + b"\n")

    def is_mended(self, bug: Bug, drawer: Drawer, device: str | None) -> bool:
        """Whether the port is right on the case of a known bug; what it draws of it now is kept."""
        from ibr_ref import oracle
        from ibr_ref.testing import bug_of

        folder = self._case(bug.name)
        return folder.exists() and bug_of(oracle.load_case(folder), partial(self._draw, drawer), device) is None

    def _case(self, name: str) -> Path:
        """Where a bug's case is."""
        return self.place / "cases" / name

    def _draw(self, drawer: Drawer, case: oracle.Case) -> oracle.Submission:
        """What the port draws of a case that is kept, which is kept too. Raises PortError where it does not."""
        from ibr_ref import oracle
        from ibr_ref.io.outputs import make_folder

        drawn = make_folder(self.place / "drawn" / case.name)
        drawer.draw(self._case(case.name).resolve(), drawn.resolve())
        return oracle.load_submission(drawn, case)

    def keep(self, found: Found, drawer: Drawer, device: str | None) -> str:
        """Write case, drawing and report; the first line of the verdict."""
        from ibr_ref import oracle
        from ibr_ref.io.outputs import make_folder
        from ibr_ref.testing import PortError

        name = found.bug.name
        about = f"{found.case.about} ibr-ref hunt, seed {found.seed}: {found.bug.array} of {found.bug.stage}."
        case = replace(found.case, name=name, about=about)
        oracle.export(case, self._case(name), force=True)
        try:
            submission = self._draw(drawer, case)
        except PortError as error:
            return f"{name}: {error}"
        problems = [str(problem) for problem in submission.problems]
        examination = oracle.examine(
            case, submission.handed, profile=device or submission.declaration, problems=problems
        )
        oracle.write_report(examination, make_folder(self.place / "reports") / f"{name}.html")
        return examination.verdict.words().partition("\n")[0]


def _line(found: Found, verdict: str) -> str:
    camera, causes = found.case.scene.camera, found.bug.causes
    why = f" Explained by {' or '.join(causes)}." if causes else ""
    return f"{verdict}{why} {camera.width} x {camera.height} pixels, after {counted(found.after, 'case')}."
