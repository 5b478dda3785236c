"""Each tolerance of the oracle has its derivation or its clause beside it: no number without a word.

A tolerance is a number that decides what is accepted: a float above 0 and at most 1/16, written as such or as a power of
two or ten. It must stand in a statement that has a comment on one of its lines or right above it, that is followed by an
attribute's docstring, or in a function whose docstring derives it. `device.py` has a source for each of its numbers.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import ibr_ref
from ibr_ref.oracle.device import PROFILES

ORACLE = Path(ibr_ref.__file__).parent / "oracle"
JUDGES = sorted(
    path
    for path in [*ORACLE.glob("*.py"), *ORACLE.glob("accept/**/*.py"), *ORACLE.glob("referees/**/*.py")]
    if path.name not in ("device.py", "plugin.py")
)
LARGEST = 1.0 / 16.0


def tolerances(tree: ast.AST) -> Iterator[ast.expr]:
    """Small numbers."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, float) and 0.0 < node.value <= LARGEST:
            yield node
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow) and _value(node.left) in (2.0, 10.0):
            exponent = _value(node.right)
            if exponent is not None and exponent < 0:
                yield node


def _value(node: ast.expr) -> float | None:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        inner = _value(node.operand)
        return None if inner is None else -inner
    return float(node.value) if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)) else None


def unexplained(source: str) -> list[int]:
    """Lines with a tolerance that nothing explains."""
    tree, lines = ast.parse(source), source.splitlines()
    parents = {child: parent for parent in ast.walk(tree) for child in ast.iter_child_nodes(parent)}
    found = []
    for node in tolerances(tree):
        statement: ast.AST = node
        while not isinstance(statement, ast.stmt):
            statement = parents[statement]
        around = lines[max(statement.lineno - 2, 0) : statement.end_lineno]
        if any("#" in line for line in around) or _documented(statement, parents):
            continue
        found.append(node.lineno)
    return found


def _documented(statement: ast.stmt, parents: dict[ast.AST, ast.AST]) -> bool:
    parent = parents[statement]
    body = getattr(parent, "body", [])
    follower = body[body.index(statement) + 1] if statement in body and statement is not body[-1] else None
    if (
        isinstance(follower, ast.Expr)
        and isinstance(follower.value, ast.Constant)
        and isinstance(follower.value.value, str)
    ):
        return True
    while not isinstance(parent, (ast.FunctionDef, ast.Module)):
        parent = parents[parent]
    return isinstance(parent, ast.FunctionDef) and len(ast.get_docstring(parent) or "") > 100


@pytest.mark.parametrize("path", JUDGES, ids=lambda path: str(path.relative_to(ORACLE)))
def test_no_tolerance_without_a_word(path: Path) -> None:
    assert unexplained(path.read_text("utf-8")) == []


def test_the_search_finds_one_that_has_none() -> None:
    assert unexplained("def near(a, b):\n    return abs(a - b) < 1e-5\n") == [2]
    assert unexplained("SLACK = 2.0**-20\n") == [1]
    assert unexplained("SLACK = 2.0**-20\n'''Of a product.'''\n") == []
    assert unexplained("# Of a product.\nSLACK = 1e-7\n") == []


def test_every_number_of_a_device_has_a_source() -> None:
    for device in PROFILES.values():
        for name, source in device.sources.items():
            assert len(source) > 20, (device.name, name)
