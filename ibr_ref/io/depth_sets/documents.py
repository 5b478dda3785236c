"""JSON documents of depth sets."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NoReturn

from ibr_ref.io.depth_sets.text import text
from ibr_ref.io.files import naming
from ibr_ref.scene import checks


def document(path: Path) -> dict[str, Any]:
    """A JSON object. Raises OSError or ValueError with the path for all else, and for numbers that are none."""
    data = text(path)
    with naming(path):
        try:
            tree = json.loads(data, parse_constant=_refused)
        except (ValueError, RecursionError) as error:
            at = f"in line {error.lineno}" if isinstance(error, json.JSONDecodeError) else "in the document"
            raise ValueError(f"found no JSON {at}, allowed: a JSON object with finite numbers") from None
        if not isinstance(tree, dict):
            raise ValueError(f"found a JSON {type(tree).__name__}, allowed: a JSON object")
        return tree


def number(tree: dict[str, Any], name: str, *, low: float, high: float) -> float:
    """A number that is there."""
    return checks.number(name, tree.get(name), low=low, high=high)


def _refused(word: str) -> NoReturn:
    raise ValueError(word)
