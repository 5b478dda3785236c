"""What the fields of a case's `case.json` mean, and which arrays it is given: the schema's own words, for its README."""

from __future__ import annotations

import json
from itertools import groupby
from typing import Any, Literal, get_args, get_origin

from ibr_ref.oracle.schema import Document, input_files
from ibr_ref.oracle.schema.base import ArrayFile, Model


def field_list(document: Document) -> str:
    """Items for `params` and `scene` and all that they hold; of lists the first element stands for all.

    What several places have alike, such as cameras, is described at the first and named at the others.
    """
    places: dict[type[Model], list[str]] = {}
    _collect("params", document.params, places)
    _collect("scene", document.scene, places)
    return "\n".join(line for model, paths in places.items() for line in _described(model, paths))


def _collect(path: str, value: Any, places: dict[type[Model], list[str]]) -> None:
    if isinstance(value, tuple) and value and isinstance(value[0], Model):
        path, value = f"{path}[]", value[0]
    if not isinstance(value, Model) or isinstance(value, ArrayFile):
        return
    places.setdefault(type(value), []).append(path)
    for name in type(value).model_fields:
        _collect(f"{path}.{name}", getattr(value, name), places)


def _described(model: type[Model], paths: list[str]) -> list[str]:
    at = ", ".join(f"`{path}`" for path in paths)
    lines = [f"- {at}: {_one_line(model.__doc__)}"]
    for alone, fields in groupby(model.model_fields.items(), lambda item: not item[1].description):
        if alone:
            lines.append(f"  - {', '.join(f'`{name}`{_choices(field.annotation)}' for name, field in fields)}")
        else:
            lines += [
                f"  - `{name}`{_choices(field.annotation)}: {_one_line(field.description)}" for name, field in fields
            ]
    return lines


def _choices(annotation: Any) -> str:
    """The values of a field that has few: ` ("dissolve" or "nearest")`."""
    if get_origin(annotation) is not Literal:
        return ""
    return f" ({' or '.join(json.dumps(value) for value in get_args(annotation))})"


def _one_line(text: str | None) -> str:
    return " ".join((text or "").split())


def input_table(document: Document) -> str:
    """Rows for all arrays that the case is given."""
    rows = [
        f"| {file.file}{' (.png too)' if file.png else ''} | {file.shape} {file.dtype} | {file.values} | {file.meaning} |"
        for file in input_files(document)
    ]
    return "\n".join(rows)
