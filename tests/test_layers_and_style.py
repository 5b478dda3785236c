"""The architecture and the style, as the tools check them: imports, lint, format, types. Configured in pyproject.toml."""

from __future__ import annotations

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path

import grimp
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


COMPILERS = {"kernel", "routine", "device"}
"""The decorators of jit.py."""
DESCRIPTIONS = ("scene", "io", "models", "oracle", "cli")
"""What callers describe and files hold; kernels see arrays."""


def compiles(path: Path) -> bool:
    """Whether a module has a function that jit.py compiles."""
    functions = [node for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.FunctionDef)]
    return any(isinstance(d, ast.Name) and d.id in COMPILERS for f in functions for d in f.decorator_list)


KERNEL_FILES = [path.relative_to(ROOT) for path in sorted((ROOT / "ibr_ref").rglob("*.py")) if compiles(path)]


@cache
def imports() -> grimp.ImportGraph:
    return grimp.build_graph("ibr_ref")


def test_kernel_files_are_found() -> None:
    assert {Path("ibr_ref/displacement/march.py"), Path("ibr_ref/pipeline/clip.py")} <= set(KERNEL_FILES)


@pytest.mark.parametrize("path", KERNEL_FILES, ids=str)
def test_kernels_see_arrays_never_descriptions(path: Path) -> None:
    """Nor does anything that they import. A new file with a kernel in it is found by its decorator."""
    module = ".".join(path.with_suffix("").parts)
    seen = imports().find_upstream_modules(module)
    described = [name for name in seen if name.split(".")[1:2] and name.split(".")[1] in DESCRIPTIONS]
    described += [name for name in seen if name.endswith(".inputs")]
    assert not described, f"{module} sees {sorted(described)}"
