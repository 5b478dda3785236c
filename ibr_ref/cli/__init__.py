"""The command line, `ibr-ref`.

Nothing here imports Numba or NumPy at the top: `--help` must answer at once. Errors are one line on standard error and
exit code 2, never a traceback.
"""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from ibr_ref.cli import bench, check, demo, displacement, export, method, reproduce, shadows, splatting

app = typer.Typer(
    name="ibr-ref",
    help="CPU reference renderer for published image-based rendering methods: the ground truth for GPU ports.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)
render_app = typer.Typer(no_args_is_help=True, help="Render your own input with one of the methods.")
render_app.command("displacement", epilog=displacement.EXAMPLES)(displacement.command)
render_app.command("splatting", epilog=splatting.EXAMPLES)(splatting.command)
render_app.command("shadows", epilog=shadows.EXAMPLES)(shadows.command)
app.add_typer(render_app, name="render")
app.command("demo", epilog=demo.EXAMPLES)(demo.command)
app.command("method", epilog=method.EXAMPLES)(method.command)
app.command("export", epilog=export.EXAMPLES)(export.command)
app.command("check", epilog=check.EXAMPLES)(check.command)
app.command("bench", epilog=bench.EXAMPLES)(bench.command)
app.command("reproduce", epilog=reproduce.EXAMPLES)(reproduce.command)


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
        code = app(standalone_mode=False)
    except usage_error as error:
        message = error.format_message()  # type: ignore[attr-defined]
        code = _fail(message) if message else 2  # without arguments the help has been printed
    except (ValueError, OSError, MemoryError) as error:
        code = _fail(str(error) or type(error).__name__)
    except (KeyboardInterrupt, typer.Abort):
        code = 130
    sys.exit(code)


def _fail(message: str) -> int:
    print("ibr-ref: " + " ".join(message.split()), file=sys.stderr)
    return 2
