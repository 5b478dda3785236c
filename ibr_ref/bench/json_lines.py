"""Results in a file, a line of JSON each: a run that has stopped goes on with what is not there."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any


def read(file: Path) -> list[dict[str, Any]]:
    """Fields of all results; none where there is no file. JSON has lists for tuples."""
    lines = file.read_text("utf-8").splitlines() if file.exists() else []
    return [{name: tuple(x) if isinstance(x, list) else x for name, x in json.loads(line).items()} for line in lines]


def append(file: Path, result: Any) -> None:
    """One more, a dataclass."""
    with file.open("a", encoding="utf-8") as lines:
        lines.write(json.dumps(asdict(result)) + "\n")
