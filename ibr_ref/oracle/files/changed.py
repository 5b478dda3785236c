"""What another version of the reference expected of ports."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import ibr_ref
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.files.folder import existing_folder
from ibr_ref.oracle.files.load import documents
from ibr_ref.oracle.files.npy import digest
from ibr_ref.oracle.schema.stages import expected
from ibr_ref.scene.checks import named, one_line


def changed_stages(case: Case, folder: str | PathLike[str]) -> list[str]:
    """Expected arrays in the folder that this version of the reference draws differently, by name; renders the case.

    Empty unless the folder was exported by another version, or arrays were exchanged together with their hashes.
    """
    return _changed(case, Path(folder))[0]


def outdated(case: Case, folder: str | PathLike[str]) -> str | None:
    """A line about a case's folder whose expected arrays are not this version's: which, and who made it; else None.

    Verdicts do not rest on them, but whoever looks at them should know. Renders the case.
    """
    changed, of, made_by = _changed(case, Path(folder))
    if not changed:
        return None
    shown = ", ".join(changed[:3]) + (", ..." if len(changed) > 3 else "")
    return (
        f"{named(folder)}: {len(changed)} of {of} expected arrays ({shown}), made by {one_line(made_by)}, are not what "
        f"ibr_ref {ibr_ref.__version__} draws, by which ports are judged: export the case anew"
    )


def _changed(case: Case, folder: Path) -> tuple[list[str], int, str]:
    """Names of those that differ, how many there are, and what wrote the folder."""
    document, manifest = documents(existing_folder(folder))
    now = {name: digest(array) for name, array in expected(case.frame).items()}
    then = {stage.name: manifest.arrays[stage.file] for stage in document.expected}
    different = [name for name in {**then, **now} if now.get(name) != then.get(name)]
    return different, len({**then, **now}), document.made_by
