"""Steps are run, kept, and put together into a page."""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import ibr_ref
from ibr_ref.io.outputs import atomic, make_folder
from ibr_ref.reproduce.findings import Found, Reproduction, Step
from ibr_ref.reproduce.page import write_page

if TYPE_CHECKING:
    from ibr_ref import progress


def run(reproduction: Reproduction, out: Path, *, again: bool, step: progress.Step) -> Path:
    """Run the steps that are not there yet; the page's path.

    Each step has a folder of its own with its pictures and `found.json`, which is written last and says from which
    sources: a step counts as done only if it is there and the package is still the same.
    """
    folder = out / f"{reproduction.number}-{reproduction.method}"
    make_folder(folder)
    results: list[tuple[Step, Found]] = []
    for part in reproduction.steps:
        step(f"{reproduction.method}: {part.title}")
        here = folder / part.name
        found = None if again else _kept(here)
        if found is None:
            shutil.rmtree(here.resolve(), ignore_errors=True)  # a link stays, and what it leads to is made anew
            make_folder(here)
            found = part.run(here, step.within)
            _keep(here, found)
        results.append((part, found))
    return write_page(reproduction, results, folder)


def _kept(folder: Path) -> Found | None:
    """What a step found when it was run from these sources; None if it has to be run."""
    try:
        if (folder / "sources.txt").read_text("utf-8").strip() != _sources():
            return None
        found = Found.model_validate_json((folder / "found.json").read_text("utf-8"))
        return found if all((folder / figure.file).is_file() for figure in found.figures) else None
    except (OSError, ValueError):
        return None


def _keep(folder: Path, found: Found) -> None:
    with atomic(folder / "found.json") as file:
        file.write(found.model_dump_json(indent=2).encode("utf-8") + b"\n")
    with atomic(folder / "sources.txt") as file:
        file.write(_sources().encode("ascii") + b"\n")


def _sources() -> str:
    """A digest of the package's sources."""
    package = Path(ibr_ref.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        digest.update(str(path.relative_to(package)).encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()
