"""Libraries of the extras, such as `ibr_ref[io]`, which only some files and commands need."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def needed(module: str, purpose: str, extra: str = "io") -> Any:
    """The module; raises ValueError that says how to have it where it is not installed."""
    try:
        return import_module(module)
    except ImportError:
        raise ValueError(f"found no {module}, needed for {purpose}: pip install 'ibr_ref[{extra}]'") from None
