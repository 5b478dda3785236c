"""What the fuzzers of files have in common: their limits, and their command line."""

from __future__ import annotations

import argparse
import resource
import signal
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

LONGEST_MESSAGE = 400
MOST_SECONDS = 10.0
"""Of processor time: the files have some thousand bytes."""
MOST_BYTES = 2**29
"""Of memory, beyond what the process has."""


class TooLong(BaseException):
    """Raised by the clock; no decoder catches it."""


@contextmanager
def limits() -> Iterator[None]:
    """Within these a process has a little more memory than before, and warnings are errors."""

    def ring(*_: object) -> None:
        raise TooLong

    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    before, handler = resource.getrlimit(resource.RLIMIT_AS), signal.signal(signal.SIGVTALRM, ring)
    resource.setrlimit(resource.RLIMIT_AS, (used + MOST_BYTES, before[1]))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
        signal.signal(signal.SIGVTALRM, handler)


@contextmanager
def clock() -> Iterator[None]:
    """What takes longer raises TooLong, within `limits`."""
    signal.setitimer(signal.ITIMER_VIRTUAL, MOST_SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)


def run(
    arguments: list[str],
    about: str | None,
    tally: Callable[[Path, int, int, int | None], Counter[str]],
    outcomes: Sequence[str],
) -> int:
    """Print the figures of `--count` inputs; 1 where something was neither read as it should be nor refused."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", type=int)
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        found = tally(Path(folder), options.count, options.seed, options.only)
    print(", ".join(f"{found[name]} {name}" for name in outcomes))
    return int(sum(found.values()) != found["read"] + found["refused"])
