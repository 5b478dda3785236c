"""Libraries of the extra `ibr_ref[io]`, which only some files need."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def needed(module: str, files: str) -> Any:
    """The module; raises ValueError that says how to have it where it is not installed."""
    try:
        return import_module(module)
    except ImportError:
        raise ValueError(f"found no {module}, needed for {files}: pip install 'ibr_ref[io]'") from None
