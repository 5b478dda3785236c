"""What import-linter has no contract for: files with kernels in them, found by their decorators."""

from __future__ import annotations

import ast
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).resolve().parent.parent


COMPILERS = {"kernel", "routine", "device"}
"""The decorators of jit.py."""
DESCRIPTIONS = ("scene", "io", "models", "oracle", "cli")
"""What callers describe and files hold; kernels see arrays."""


def compiles(path: Path) -> bool:
    """Whether a module has a function that jit.py compiles."""
    text = path.read_text("utf-8")
    if "ibr_ref.jit" not in text:  # sooner than parsing all of them, in every process
        return False
    functions = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)]
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


ON_FIRST_USE = {("ibr_ref.oracle.cases.case", "ibr_ref.oracle.power")}
"""What a case can be asked for, by those who have referees."""


def test_no_modules_import_each_other() -> None:
    """Not within functions either. Types may name each other."""
    graph = grimp.build_graph("ibr_ref", exclude_type_checking_imports=True)
    sorter: TopologicalSorter[str] = TopologicalSorter()
    for module in graph.modules - {"ibr_ref"}:
        seen = graph.find_modules_directly_imported_by(module) - {"ibr_ref"}
        sorter.add(module, *(name for name in seen if (module, name) not in ON_FIRST_USE))
    sorter.prepare()  # raises CycleError, which names the circle
