"""The command line, `ibr-ref`.

Nothing here imports Numba or NumPy at the top: `--help` must answer at once. Errors are one line on standard error and
exit code 2, never a traceback.
"""

from __future__ import annotations

import os
import sys
import warnings
from typing import Annotated

import typer

from ibr_ref import methods
from ibr_ref.cli import bench, check, conformance, demo, draw, export, hunt, method, reproduce, view
from ibr_ref.cli.command import Command
from ibr_ref.cli.interruption import CODE, heard

_BROKEN_PIPE = 141
"""The exit code that a shell gives to a command whose reader has gone; no verdict has it."""

app = typer.Typer(
    name="ibr-ref",
    help="CPU reference renderer for published image-based rendering methods: the ground truth for GPU ports.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)
render_app = typer.Typer(no_args_is_help=True, help="Render your own input with one of the methods.")
for _name, _room in ((each.name, each.command.open()) for each in methods.records() if each.command is not None):
    render_app.command(_name, cls=Command, epilog=_room.EXAMPLES)(_room.command)
app.add_typer(render_app, name="render")
sweep_app = typer.Typer(no_args_is_help=True, help="Which parameters are good enough: all combinations, measured.")
for _name, _room in ((m.name, m.sweep_command.open()) for m in methods.records() if m.sweep_command is not None):
    sweep_app.command(_name, cls=Command, epilog=_room.EXAMPLES)(_room.command)
app.add_typer(sweep_app, name="sweep")
view_app = typer.Typer(no_args_is_help=True, help="Look at what is rendered, or at a case, on a page with sliders.")
for _name, _view in view.commands().items():
    view_app.command(_name, cls=Command, epilog=view.EXAMPLES)(_view)
app.add_typer(view_app, name="view")
app.command("demo", cls=Command, epilog=demo.EXAMPLES)(demo.command)
app.command("method", cls=Command, epilog=method.EXAMPLES)(method.command)
app.command("export", cls=Command, epilog=export.EXAMPLES)(export.command)
app.command("draw", cls=Command, epilog=draw.EXAMPLES)(draw.command)
app.command("check", cls=Command, epilog=check.EXAMPLES)(check.command)
app.command("conformance", cls=Command, epilog=conformance.EXAMPLES)(conformance.command)
app.command("hunt", cls=Command, epilog=hunt.EXAMPLES)(hunt.command)
app.command("bench", cls=Command, epilog=bench.EXAMPLES)(bench.command)
app.command("reproduce", cls=Command, epilog=reproduce.EXAMPLES)(reproduce.command)


def _print_version(wanted: bool) -> None:
    if wanted:
        import ibr_ref

        typer.echo(f"ibr-ref {ibr_ref.__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and exit.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    pass


def _command_line_error() -> type[Exception]:
    """The base of all of Typer's own errors: click's ClickException, of which newer versions carry a copy."""
    return next(base for base in typer.BadParameter.__mro__ if base.__name__ == "ClickException")


def main() -> None:
    """Run the command line; bad input ends in one line and exit code 2, an interruption in exit code 130."""
    usage_error = _command_line_error()
    try:
        with warnings.catch_warnings(), heard():
            warnings.simplefilter("ignore")  # they are for those who call a library; what they lead to is one line
            code = app(standalone_mode=False)
    except usage_error as error:
        message = error.format_message()  # type: ignore[attr-defined]
        code = _fail(message) if message else 2  # without arguments the help has been printed
    except BrokenPipeError:  # whoever reads standard output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # or Python complains of what it could not flush
        code = _BROKEN_PIPE
    except MemoryError as error:
        code = _fail(f"out of memory: {error}" if str(error) else "out of memory")
    except (ValueError, OSError) as error:
        code = _fail(str(error) or type(error).__name__)
    except (KeyboardInterrupt, typer.Abort):
        code = CODE
    sys.exit(code)


def _fail(message: str) -> int:
    from ibr_ref.scene.checks import LONGEST_MESSAGE, one_line

    print("ibr-ref: " + one_line(message, LONGEST_MESSAGE), file=sys.stderr)
    return 2
