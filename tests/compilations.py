"""What a command compiles from nothing: `python -m tests.compilations render displacement --height ... --out ...`.

Kernels by the processor time that each took with all that only it calls, and of that what is its own; the whole command.
Processor time, for wall time says as much of the machine's other work. Of `demo`, whose methods are processes of their own,
only what this process compiles is seen.
"""

from __future__ import annotations

import os
import sys
import time
from tempfile import TemporaryDirectory
from typing import Any


def main() -> None:
    """Run the command in an empty cache, and print the table on standard error."""
    with TemporaryDirectory() as folder:
        os.environ["NUMBA_CACHE_DIR"] = folder  # before Numba is imported
        from numba.core import event

        from ibr_ref.cli import main as command

        unfinished: list[list[float]] = []  # when it started, and what of the time went into others
        rows: list[tuple[float, float, int, str]] = []  # seconds in all, its own, how deep, the name

        class Times(event.Listener):
            """Compilations are nested, each in its caller's."""

            def on_start(self, event: Any) -> None:
                """A function is to be compiled."""
                unfinished.append([time.process_time(), 0.0])

            def on_end(self, event: Any) -> None:
                """It is."""
                started, others = unfinished.pop()
                taken = time.process_time() - started
                if unfinished:
                    unfinished[-1][1] += taken
                function = event.data["dispatcher"].py_func
                rows.append((taken, taken - others, len(unfinished), f"{function.__module__}.{function.__name__}"))

        event.register("numba:compile", Times())
        sys.argv = ["ibr-ref", *sys.argv[1:]]
        try:
            command()
        finally:
            kernels = sorted((row for row in rows if row[2] == 0), reverse=True)
            for taken, own, _, name in kernels:
                print(f"{taken:7.2f} {own:7.2f}  {name}", file=sys.stderr)
            print(f"{sum(row[0] for row in kernels):7.2f}          {len(rows)} compilations", file=sys.stderr)
            print(f"{time.process_time():7.2f}          the whole command, CPU seconds", file=sys.stderr)


if __name__ == "__main__":
    main()
