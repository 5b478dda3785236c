"""Read a case's folder back, with nothing believed."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from ibr_ref.io.files import naming
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.files.consistency import check_arrays, check_cameras, check_expected, check_picture, check_same
from ibr_ref.oracle.files.folder import existing_folder, file_inside, small_file
from ibr_ref.oracle.files.manifest import Manifest, digest_of_bytes
from ibr_ref.oracle.files.npy import Accept, Header, digest, read_array
from ibr_ref.oracle.files.pictures import read_bytes
from ibr_ref.oracle.files.problem import UnusableError, field_problem
from ibr_ref.oracle.files.write import LARGEST_DOCUMENT
from ibr_ref.oracle.schema import Document, build, describe_inputs, input_files, read
from ibr_ref.oracle.schema.base import Inputs, Stored, StoredFile


def load_case(folder: str | PathLike[str]) -> Case:
    """The case of a folder; the reference draws it with the same bits as before it was exported.

    Every file is read and its hash compared; the scene is built, described anew and compared with the document, number by
    number, so that nothing contradicts what it follows from: no matrix another, no PNG its array, no prepared map its
    scene. near, far and eye may differ from the matrices by rounding (`schema.camera.contradiction`), and intrinsics by
    1e-9 of the largest. Raises OSError or ValueError, one line that names the file, for anything else.
    """
    path = existing_folder(folder)
    document, manifest = documents(path)
    stored = _arrays(path, document, manifest)
    where = path / "case.json"
    with naming(where):
        check_cameras("scene", document.scene)
        case, again, inputs = _built(document, stored)
    check_expected(f"{where}: ", document)
    check_same(f"{where}: ", _scene_of(document), _scene_of(again))
    made = {name: digest(array) for name, array in {**inputs.arrays, **inputs.images}.items()}
    check_arrays(path, made, manifest.arrays)
    return case


def _built(document: Document, stored: Stored) -> tuple[Case, Document, Inputs]:
    """The case, and what it is described as. Raises ValueError for what is none."""
    try:
        case = build(document, stored)
        return (case, *describe_inputs(case))
    except ValidationError as error:
        raise field_problem("scene", error) from None


def documents(path: Path) -> tuple[Document, Manifest]:
    """`case.json` and `manifest.json` of a folder, checked by their models, and that they name the same files."""
    data = small_file(path, "case.json", LARGEST_DOCUMENT)
    try:
        document = read(data)
    except ValidationError as error:
        raise field_problem(path / "case.json", error) from None
    try:
        manifest = Manifest.model_validate_json(small_file(path, "manifest.json", LARGEST_DOCUMENT))
    except ValidationError as error:
        raise field_problem(path / "manifest.json", error) from None
    for name in ("case.json", "README.md"):
        text = data if name == "case.json" else small_file(path, name, LARGEST_DOCUMENT)
        _check_hash(path / name, digest_of_bytes(text), manifest.documents.get(name))
    files: list[StoredFile] = [*input_files(document), *document.expected]
    named = {name for file in files for name in (file.file, file.png) if name}
    different = sorted(named ^ set(manifest.arrays))
    if different:
        raise UnusableError(path / "manifest.json", f"{different[0]} in one of both", "the arrays that case.json names")
    return document, manifest


def _arrays(path: Path, document: Document, manifest: Manifest) -> Stored:
    """The inputs, by file; what is expected is read and compared, and not kept."""
    stored: Stored = {}
    files: list[StoredFile] = [*input_files(document), *document.expected]
    for file in files:
        where = file_inside(path, file.file)
        array = read_array(where, _like(where, file.dtype, file.shape))
        _check_hash(where, digest(array), manifest.arrays[file.file])
        if file.file.startswith("inputs/"):
            stored[file.file] = array
        if file.png is not None:
            picture = file_inside(path, file.png)
            codes = read_bytes(picture, [file.shape])
            _check_hash(picture, digest(codes), manifest.arrays[file.png])
            check_picture(picture, file, array, codes)
    return stored


def _like(where: Path, dtype: str, shape: tuple[int, ...]) -> Accept:
    def accept(header: Header) -> None:
        if (header.dtype, header.shape) != (np.dtype(dtype), shape):
            raise UnusableError(where, f"{header.shape} {header.dtype}", f"{shape} {dtype}, as case.json says")

    return accept


def _check_hash(where: Path, found: str, allowed: str | None) -> None:
    if found != allowed:
        raise UnusableError(
            where, f"contents with the hash {found[:16]}...", f"{(allowed or 'none')[:16]}..., of the manifest"
        )


def _scene_of(document: Document) -> dict[str, Any]:
    return {"params": document.params, "scene": document.scene}
