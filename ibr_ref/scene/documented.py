"""Classes whose `help` says what each field means: what stands under the field in the source, and who reads it."""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any, TypeVar

Class = TypeVar("Class", bound=type)


def documented(choice: str = "", read_by: Mapping[str, Sequence[str]] | None = None) -> Callable[[Class], Class]:
    """A decorator. read_by: fields that are read by some values of the field `choice` alone, and these."""

    def decorate(kind: Class) -> Class:
        kind.__doc__ = _Meanings(kind, choice, read_by or {})  # type: ignore[assignment]
        return kind

    return decorate


class _Meanings:
    """In place of the docstring of a class: made when it is asked for, since sources take their time to read."""

    def __init__(self, kind: type, choice: str, read_by: Mapping[str, Sequence[str]]) -> None:
        self.kind, self.own, self.choice, self.read_by = kind, kind.__doc__ or "", choice, read_by

    def __get__(self, instance: object, owner: type | None = None) -> str:
        lines = [inspect.cleandoc(self.own), ""]
        for name, meaning in meanings(self.kind).items():
            readers = self.read_by.get(name)
            who = f" Read by {self.choice} {' | '.join(readers)} alone." if readers else ""
            lines.append(f"{name}: {meaning}{who}")
        return "\n".join(lines)


def meanings(kind: type) -> dict[str, str]:
    """By field what the string under it says, on one line; empty where there is no source."""
    try:
        tree = ast.parse(inspect.getsource(sys.modules[kind.__module__]))
    except (OSError, SyntaxError, TypeError):
        return {}
    (body,) = (node.body for node in tree.body if isinstance(node, ast.ClassDef) and node.name == kind.__name__)
    fields: dict[str, str] = {node.target.id: "" for node in body if _is_field(node)}  # type: ignore[attr-defined]
    for node, below in pairwise(body):
        if _is_field(node) and isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant):
            target: Any = node
            fields[target.target.id] = " ".join(str(below.value.value).split())
    return fields


def _is_field(node: ast.stmt) -> bool:
    return isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
