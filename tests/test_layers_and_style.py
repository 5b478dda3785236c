"""The architecture and the style, as the tools check them: imports, lint, format, types. Configured in pyproject.toml."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent


def beside_python(name: str) -> str:
    """A script of the environment that the tests run in."""
    scripts = Path(sys.executable).parent
    found = [
        path for path in (scripts / name, scripts / f"{name}.exe", scripts / "Scripts" / f"{name}.exe") if path.exists()
    ]
    assert found, f"{name} is not installed beside {sys.executable}: pip install -e .[test]"
    return str(found[0])


COMMANDS = {
    "imports run downwards": ["lint-imports"],
    "ruff check": ["ruff", "check"],
    "ruff format": ["ruff", "format", "--check"],
    "mypy": ["mypy"],
}


@pytest.mark.parametrize("name", COMMANDS)
def test_the_tool_finds_nothing(name: str) -> None:
    script, *arguments = COMMANDS[name]
    run = subprocess.run(
        [beside_python(script), *arguments],
        cwd=ROOT,
        capture_output=True,
        encoding="utf-8",
        errors="replace",
        timeout=300,
    )
    assert run.returncode == 0, f"{' '.join(COMMANDS[name])}:\n{run.stdout}\n{run.stderr}"
