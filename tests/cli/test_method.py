"""`ibr-ref method`: the pages, at once, plain in a pipe and rendered on a terminal."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from ibr_ref import pages
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line


@pytest.mark.parametrize("name", pages.names())
def test_a_pipe_gets_the_page(run: Run, name: str) -> None:
    code, out, err = run("method", name)
    assert (code, err) == (0, "")
    assert out == pages.page(name)


def test_an_unknown_page(run: Run) -> None:
    assert_one_line(run("method", "relief"), "relief", "displacement | splatting | shadows | conventions")


def test_it_does_not_import_numpy() -> None:
    code = "import sys; from ibr_ref import cli; sys.argv = ['ibr-ref', 'method', 'shadows']\n"
    code += "try: cli.main()\nexcept SystemExit: pass\n"
    code += "assert not {'numba', 'numpy'} & set(sys.modules), 'slow imports'"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no terminals to open here")
def test_a_terminal_gets_it_rendered() -> None:
    leader, follower = os.openpty()
    try:
        environment = {**os.environ, "TERM": "xterm", "COLUMNS": "70", "NO_COLOR": "1"}
        command = [sys.executable, "-c", "from ibr_ref.cli import main; main()", "method", "conventions"]
        with subprocess.Popen(command, stdout=follower, stderr=subprocess.PIPE, env=environment) as process:
            os.close(follower)
            shown = b""
            while True:
                try:
                    part = os.read(leader, 65536)
                except OSError:  # Linux: the other end is closed
                    break
                if not part:
                    break
                shown += part
            assert process.wait(timeout=60) == 0
    finally:
        os.close(leader)
    text = shown.decode()
    assert "## Numbers" not in text
    assert "Numbers" in text
    assert "•" in text
