"""An exported case as plain namespaces, read with json and NumPy alone: all that a port knows of it.

Names are those of `case.json`. Lists of numbers are arrays, named files are what they stand for: of bytes that mean k / 255
the quotients, of counts of covered samples the coverage.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np


@dataclass(frozen=True)
class GivenCase:
    """What a port is given."""

    name: str
    method: str
    scene: Any
    """As `case.json` has it; `perspective` of every camera, and `image` of shadow maps, are there besides."""
    params: Any
    expected: tuple[str, ...]
    """Names under which arrays may be handed in."""


def read_case(folder: Path) -> GivenCase:
    """The case that lies in a folder."""
    document = json.loads((folder / "case.json").read_text(encoding="utf-8"))
    return given_case(document, lambda file: np.load(folder / file, allow_pickle=False))


def given_case(document: dict[str, Any], array: Callable[[str], np.ndarray]) -> GivenCase:
    """The case of a document; array: reads a file that it names."""
    scene = _part(document["scene"], array)
    maps = getattr(scene, "maps", None)
    if maps is not None:
        maps.image = maps.texels / (maps.samples**2 if maps.content == "mask" else 1.0)
    return GivenCase(
        name=document["name"],
        method=document["method"],
        scene=scene,
        params=_part(document["params"], array),
        expected=tuple(stage["name"] for stage in document["expected"]),
    )


def _part(value: Any, array: Callable[[str], np.ndarray]) -> Any:
    """A part of the document: a file's array, an object as a namespace, numbers as an array, anything else as it is."""
    if isinstance(value, dict) and "file" in value:
        stored = array(value["file"])
        return stored / 255.0 if value["values"] == "k / 255" else stored
    if isinstance(value, dict):
        part = SimpleNamespace(**{name: _part(item, array) for name, item in value.items()})
        if "projection" in value:
            part.perspective = value["projection"] == "perspective"
        return part
    if isinstance(value, list):
        objects = bool(value) and isinstance(value[0], dict)
        return [_part(item, array) for item in value] if objects else np.asarray(value, np.float64)
    return value
