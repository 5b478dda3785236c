"""`ibr-ref view`: what `render` would draw, a case, or a case and what a port drew of it, on a page."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref import methods
from ibr_ref.cli import options
from ibr_ref.cli.described import beside
from ibr_ref.cli.what_goes_with_what import ALWAYS, Beside
from ibr_ref.methods import Method

if TYPE_CHECKING:
    from ibr_ref.viewer import Subject

EXAMPLES = """
Examples:

    ibr-ref view displacement --height h.png --color c.png

    ibr-ref view shadows --caster cow.obj --samples 9

    ibr-ref view case displacement-box

    ibr-ref view case cases/box drawn/box

The page is on loopback alone, for whoever has the token in its address. Ctrl-C ends it.
"""

Port = Annotated[int, typer.Option(parser=options.whole, help="Of the page's address; 0: one that is free.")]
NoBrowser = Annotated[bool, typer.Option("--no-browser", help="Print the address, and open nothing.")]


def commands() -> dict[str, Callable[..., None]]:
    """By name: one for a case, and one for each method that has a page and a command to render with."""
    with_pages = [m for m in methods.records() if m.viewable is not None and m.command is not None]
    return {"case": case, **{method.name: _of(method) for method in with_pages}}


def _of(method: Method) -> Callable[..., None]:
    assert method.command is not None
    room = method.command.open()

    @beside(room.read)
    def command(port: Port = 0, no_browser: NoBrowser = False, **described: Any) -> None:
        from ibr_ref.viewer import Subject

        scene, params, inputs, _ = room.read(**described)
        if not isinstance(scene, method.package.open().Scene):
            raise typer.BadParameter(f"{type(scene).__name__}: found several casters or lights, allowed: one of each")
        serve(Subject(scene=scene, params=params, inputs=inputs, title=method.title), port, no_browser)

    command.__doc__ = f"{method.title} ({method.source}) of what `ibr-ref render {method.name}` takes."
    return command


def case(
    case: Annotated[
        str, typer.Argument(help="Folder that `ibr-ref export` wrote, or a built-in case's name.", show_default=False)
    ],
    drawn: Annotated[
        Path | None, typer.Argument(help="Folder with what a port drew of it.", show_default=False)
    ] = None,
    port: Port = 0,
    no_browser: NoBrowser = False,
) -> None:
    """A case, and what a port drew of it beside the reference."""
    serve(_subject(case, drawn), port, no_browser)


def _subject(word: str, drawn: Path | None) -> Subject:
    """Raises ValueError and OSError for what is no case, more than one, or a drawing with files that cannot be used."""
    from ibr_ref import oracle
    from ibr_ref.oracle.choice import chosen
    from ibr_ref.scene import checks
    from ibr_ref.viewer import Subject

    choices = chosen([word])
    if len(choices) != 1:
        raise checks.reject("case", word, f"one case, not {len(choices)}")
    found = choices[0].make()
    drawing = {}
    if drawn is not None:
        submission = oracle.load_submission(drawn, found)
        if submission.problems:
            raise ValueError(str(submission.problems[0]))
        drawing = dict(submission.handed)
    return Subject(
        scene=found.scene, params=found.params, inputs=found.inputs, title=found.name, drawing=drawing
    )  # fmt: skip


def serve(subject: Subject, port: int, no_browser: bool) -> None:
    """Until somebody ends it."""
    import webbrowser

    from ibr_ref.viewer import Server, Session

    with Server(Session(subject), port) as server:
        typer.echo(server.address)
        if not no_browser:
            webbrowser.open(server.address)
        server.serve_forever()


def goes_with(name: str) -> dict[str, Beside]:
    """Beside which others each option of `ibr-ref view NAME` is read: those of `render`, without what it writes."""
    room = None if name == "case" else methods.named(name).command
    rules = {} if room is None else room.open().goes_with()
    parameters = signature(commands()[name]).parameters
    return {param: _among(rules.get(param, ALWAYS), parameters) for param in parameters if param != "context"}


def _among(rule: Beside, parameters: Iterable[str]) -> Beside:
    """The rule without alternatives that need other parameters."""
    return Beside(rule.why, *(each for each in rule.alternatives if set(each) <= set(parameters)))
