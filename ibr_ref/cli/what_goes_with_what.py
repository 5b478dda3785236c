"""Which options go with which: one table for all commands.

It says for every parameter of every command beside which others it is read; `command.Command` refuses it beside others.
Those of `render` and `view` are said beside the commands, `goes_with` there. Which method reads which field of its
`Params` is said by the method, in `READ_BY`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

from ibr_ref import methods

GIVEN, ABSENT = object(), object()
"""In place of values: any, or none."""

Others = dict[str, Any]
"""Values of other parameters: each one, a tuple of those that will do, GIVEN or ABSENT."""


class Beside:
    """A parameter that is read only beside others: all of one of the alternatives."""

    def __init__(self, why: str, *alternatives: Others) -> None:
        self.why, self.alternatives = why, alternatives


ALWAYS = Beside("")


def always(*names: str) -> dict[str, Beside]:
    """Parameters that are read beside whatever there is."""
    return dict.fromkeys(names, ALWAYS)


def table() -> dict[str, dict[str, Beside]]:
    """By command and parameter."""
    return {command: rules(command) for command in _commands()}


@cache
def rules(command: str) -> dict[str, Beside]:
    """Those of one command: a method's are imported for its own alone."""
    return _commands()[command]()


def _commands() -> dict[str, Callable[[], dict[str, Beside]]]:
    view = methods.Room("ibr_ref.cli.view").open()
    return {
        **{f"render {m.name}": m.command.open().goes_with for m in methods.records() if m.command is not None},
        **{
            f"sweep {m.name}": m.sweep_command.open().goes_with
            for m in methods.records()
            if m.sweep_command is not None
        },
        "export": _export,
        "check": _check,
        "hunt": _hunt,
        "draw": lambda: always("case", "folder", "with_", "adapter"),
        **{f"view {name}": partial(view.goes_with, name) for name in view.commands()},
        "conformance": _conformance,
        "probe": lambda: always("case", "drawn", "out"),
        "demo": lambda: always("out"),
        "bench": _bench,
        "method": lambda: always("name"),
        "reproduce": lambda: always("paper", "out", "again"),
    }


def _conformance() -> dict[str, Beside]:
    drawn: Others = {"compare": ABSENT}
    return {
        **{name: Beside("two runs are compared, nothing is drawn", drawn) for name in ("case", "with_", "adapter")},
        **always("out", "compare"),
    }


def _hunt() -> dict[str, Beside]:
    return {
        **always("method", "system", "seconds", "seed", "out", "device"),
        "port": Beside("there is one port", {"page": ABSENT}),
        "serve": Beside("it says how a command is told", {"port": GIVEN}),
        "page": Beside("there is one port", {"port": ABSENT}),
    }


def _bench() -> dict[str, Beside]:
    benches = {method.name: method.bench.open() for method in methods.records() if method.bench is not None}
    of_photographs = tuple(name for name, bench in benches.items() if bench.READS_MSR)
    return {
        **always("method", "repeat", "json"),
        "msr": Beside("photographs are splatted", {"method": ("all", *of_photographs)}),
    }


def _export() -> dict[str, Beside]:
    alone: Others = {"list_": ABSENT, "schema": ABSENT}
    return {
        **{name: Beside("nothing is written", alone) for name in ("case", "folder", "force")},
        "list_": Beside("one thing is printed", {"schema": ABSENT}),
        "schema": Beside("one thing is printed", {"list_": ABSENT}),
    }


_OF_FOLDERS = ("device", "report", "junit", "watch", "fail_fast")
"""Options of `check` that are about folders."""


def _check() -> dict[str, Beside]:
    alone: Others = {"self_test": ABSENT}
    return {
        **{name: Beside("--self-test takes no folders", alone) for name in ("case", "port")},
        **{name: Beside("--self-test prints its tables alone", alone) for name in _OF_FOLDERS},
        **always("json", "self_test"),
        **{name: Beside(f"--{name} goes with --self-test", {"self_test": GIVEN}) for name in ("method", "coarse")},
    }
