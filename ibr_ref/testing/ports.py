"""Ports that are programs of their own: started for every case, or once and told of one after another."""

from __future__ import annotations

import queue
import shlex
import subprocess
import tempfile
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Protocol

from ibr_ref.io.outputs import make_folder
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.files import Submission, export, load_submission
from ibr_ref.scene import checks
from ibr_ref.testing.judging import PortError

LONGEST = 60.0
"""Seconds that a port may take for a case."""

_OK = "ok"
"""What a served port answers when it has drawn."""


class Drawer(Protocol):
    """Whatever draws a case's folder."""

    def draw(self, case: Path, out: Path) -> None:
        """Read a case's folder, write into another. Raises PortError where it does not draw."""

    def close(self) -> None:
        """End it."""


def port_of(drawer: Drawer, case: Case) -> Submission:
    """What it draws, in folders that are gone afterwards. Raises PortError where it does not."""
    with tempfile.TemporaryDirectory(prefix="ibr_ref-") as folder:
        place = Path(folder)
        export(case, place / "case")
        drawer.draw(place / "case", make_folder(place / "out"))
        return load_submission(place / "out", case)


class Program:
    """A command with {case} and {out} in place of the folder that it reads and the one that it writes to."""

    def __init__(self, command: str) -> None:
        """Raise ValueError for a command without them, or none at all."""
        self.words = _words(command)
        if not all(any(place in word for word in self.words) for place in ("{case}", "{out}")):
            raise checks.reject("port", command, 'a command with {case} and {out} in it: "./my_port {case} {out}"')

    def draw(self, case: Path, out: Path) -> None:
        """Run it. Raises PortError with its exit code and OSError where there is no such program."""
        words = [word.replace("{case}", str(case)).replace("{out}", str(out)) for word in self.words]
        ended = _run(words)
        if ended:
            raise PortError(ended)

    def close(self) -> None:
        """It has ended."""


class Served:
    """A command that is started once: it is told "CASE<tab>OUT" on a line of standard input, and answers each with a line.

    The answer is "ok", or why it did not draw. A program that ends, or is silent for `LONGEST`, is started again.
    """

    def __init__(self, command: str) -> None:
        """Raise ValueError for what is no command."""
        self.words = _words(command)
        self._process: subprocess.Popen[str] | None = None
        self._answers: queue.Queue[str | None] = queue.Queue()

    def draw(self, case: Path, out: Path) -> None:
        """Tell it. Raises PortError with its answer, or how it ended, and OSError where there is no such program."""
        process = self._started()
        assert process.stdin is not None
        try:
            process.stdin.write(f"{case}\t{out}\n")
            process.stdin.flush()
            answer = self._answers.get(timeout=LONGEST)
        except queue.Empty:
            self.close()
            raise PortError(f"no answer within {LONGEST:g} s") from None
        except OSError:  # it has ended: nobody reads
            answer = None
        if answer is None:
            code = process.wait()
            self.close()
            raise PortError(f"exit code {code}")
        if answer.strip() != _OK:
            raise PortError(checks.one_line(answer))

    def close(self) -> None:
        """End the program, if it runs."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            if self._process.stdin is not None:
                with suppress(OSError):  # of what nobody reads any more
                    self._process.stdin.close()
            self._process = None

    def _started(self) -> subprocess.Popen[str]:
        if self._process is None:
            self._answers = queue.Queue()
            self._process = _opened(self.words)
            assert self._process.stdout is not None
            threading.Thread(target=_listen, args=(self._process.stdout, self._answers), daemon=True).start()
        return self._process


def _listen(lines: IO[str], answers: queue.Queue[str | None]) -> None:
    """Pass lines on; None is their end."""
    with lines:
        for line in lines:
            answers.put(line)
    answers.put(None)


def _opened(words: Sequence[str]) -> subprocess.Popen[str]:
    try:
        return subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )  # fmt: skip
    except OSError as error:
        raise _no_program(words, error) from None


def _words(command: str) -> list[str]:
    try:
        words = shlex.split(command)
    except ValueError as error:
        raise checks.reject("port", command, f"a command as a shell would read it ({error})") from None
    if not words:
        raise checks.reject("port", command, "a command")
    return words


def _run(words: Sequence[str]) -> str:
    """How the program ended, if not well."""
    try:
        code = subprocess.run(
            words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=LONGEST
        ).returncode
    except subprocess.TimeoutExpired:
        return f"no end within {LONGEST:g} s"
    except OSError as error:
        raise _no_program(words, error) from None
    return f"exit code {code}" if code else ""


def _no_program(words: Sequence[str], error: OSError) -> OSError:
    return OSError(f"{checks.named(words[0])}: cannot be run ({error.strerror})")
