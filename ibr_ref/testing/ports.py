"""A port that is a program of its own."""

from __future__ import annotations

import shlex
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.files import Submission, export, load_submission
from ibr_ref.scene import checks
from ibr_ref.testing.judging import PortError

LONGEST = 60.0
"""Seconds that a port may take for a case."""


class Program:
    """A command with {case} and {out} in place of the folder that it reads and the one that it writes to."""

    def __init__(self, command: str) -> None:
        """Raise ValueError for a command without them, or none at all."""
        try:
            self.words = shlex.split(command)
        except ValueError as error:
            raise checks.reject("port", command, f"a command as a shell would read it ({error})") from None
        if not all(any(place in word for word in self.words) for place in ("{case}", "{out}")):
            raise checks.reject("port", command, 'a command with {case} and {out} in it: "./my_port {case} {out}"')

    def __call__(self, case: Case) -> Submission:
        """What it draws, in folders that are gone afterwards. Raises PortError where it ends in an error."""
        with tempfile.TemporaryDirectory(prefix="ibr_ref-") as folder:
            place = Path(folder)
            export(case, place / "case")
            self.draw(place / "case", place / "out")
            return load_submission(place / "out", case)

    def draw(self, case: Path, out: Path) -> None:
        """Run it. Raises PortError with its exit code and OSError where there is no such program."""
        out.mkdir(parents=True, exist_ok=True)
        words = [word.replace("{case}", str(case)).replace("{out}", str(out)) for word in self.words]
        ended = _run(words)
        if ended:
            raise PortError(ended)


def _run(words: Sequence[str]) -> str:
    """How the program ended, if not well."""
    try:
        code = subprocess.run(
            words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=LONGEST
        ).returncode
    except subprocess.TimeoutExpired:
        return f"no end within {LONGEST:g} s"
    except OSError as error:
        raise OSError(f"{checks.named(words[0])}: cannot be run ({error.strerror})") from None
    return f"exit code {code}" if code else ""
