"""Write a case as a folder that any language can read."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ibr_ref.io import write_image
from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.files.folder import atomic_folder, small_file
from ibr_ref.oracle.files.manifest import Manifest, digest_of_bytes
from ibr_ref.oracle.files.npy import digest, write_array
from ibr_ref.oracle.files.problem import field_problem
from ibr_ref.oracle.files.text import json_text, readme
from ibr_ref.oracle.schema.base import Inputs
from ibr_ref.oracle.schema.document import FORMAT, Document, describe
from ibr_ref.oracle.schema.stages import expected
from ibr_ref.scene.checks import named, one_line

LARGEST_DOCUMENT = 2**25
"""Bytes of `case.json` and of `manifest.json`, at the most."""


def export(case: Case, folder: str | PathLike[str], *, force: bool = False) -> None:
    """Write `case.json`, `manifest.json`, `README.md`, `inputs/` and `expected/`: all of it, or nothing.

    The same case makes the same bytes. A folder that holds an export of the same case and nothing else is replaced;
    force: of any case, whatever else it holds. Raises OSError for other places, and ValueError for cases that cannot be
    written down.
    """
    path = Path(folder)
    check_replaceable(path, case.name, force=force)
    try:
        document, inputs = describe(case)
    except ValidationError as error:
        raise field_problem(f"case {case.name!r}", error) from None
    with atomic_folder(path) as made:
        _write(made, case, document, inputs)


def check_replaceable(path: Path, name: str, *, force: bool = False) -> None:
    """Raise OSError where `export` may not write a case of that name."""
    try:
        present = sorted(entry.name for entry in path.iterdir())
    except FileNotFoundError:
        return
    except OSError as error:
        raise OSError(f"{named(path)}: cannot be written ({error.strerror})") from None
    if not present:
        return
    held = _exported_name(path)
    if held is None:
        raise FileExistsError(
            f"{named(path)}: is a folder with other things in it, allowed: a new one, or an exported case"
        )
    if force:
        return
    if held != name:
        raise FileExistsError(
            f"{named(path)}: holds the case {one_line(repr(held))}, allowed: a new folder, or one of {name!r} (or force)"
        )
    strangers = _strangers(path)
    if strangers:
        stranger = one_line(repr(strangers[0]))
        raise FileExistsError(
            f"{named(path)}: holds {stranger}, which no export wrote; allowed: an export alone (or force)"
        )


def _exported_name(path: Path) -> str | None:
    """Which case lies there, by any version of the format; None if none does."""
    try:
        fields = json.loads(small_file(path, "case.json", LARGEST_DOCUMENT))
        name = fields["name"] if fields["format"] == FORMAT else None
    except (ValueError, OSError, KeyError, TypeError, RecursionError):
        return None
    return name if isinstance(name, str) else None


def _strangers(path: Path) -> list[str]:
    """What the folder holds besides what its manifest lists."""
    try:
        manifest = Manifest.model_validate_json(small_file(path, "manifest.json", LARGEST_DOCUMENT))
    except ValueError:
        return ["manifest.json"]
    ours = {"manifest.json", *manifest.arrays, *manifest.documents, "inputs", "expected"}
    return sorted({entry.relative_to(path).as_posix() for entry in path.rglob("*")} - ours)


def _write(made: Path, case: Case, document: Document, inputs: Inputs) -> None:
    (made / "inputs").mkdir()
    (made / "expected").mkdir()
    outputs = expected(case.frame)
    arrays = {**inputs.arrays, **{stage.file: outputs[stage.name] for stage in document.expected}}
    images = {**inputs.images, "expected/color.png": color_bytes(case.frame.color)}
    for name, array in arrays.items():
        with (made / name).open("wb") as file:
            write_array(file, array)
    for name, image in images.items():
        write_image(made / name, image / 255.0)
    fields = document.model_dump(mode="json")
    fields["expected"] = fields.pop("expected")  # last: it is the longest
    documents = {"case.json": json_text(fields) + "\n", "README.md": readme(document)}
    data = {name: text.encode() for name, text in documents.items()}
    hashes: Any = {name: digest_of_bytes(text) for name, text in data.items()}
    manifest = Manifest(
        arrays={name: digest(array) for name, array in {**arrays, **images}.items()},
        documents=hashes,
    )
    data["manifest.json"] = (json_text(manifest) + "\n").encode()
    for name, text in data.items():
        (made / name).write_bytes(text)
