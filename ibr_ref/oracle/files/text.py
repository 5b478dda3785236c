"""The text of the documents of a case's folder."""

from __future__ import annotations

import json
from typing import Any

from pydantic import BaseModel

from ibr_ref import displacement, shadows, splatting
from ibr_ref.oracle.referees.reads import READS
from ibr_ref.oracle.schema import Document

_METHODS = {"displacement": displacement, "splatting": splatting, "shadows": shadows}


def json_text(value: Any, indent: str = "") -> str:
    """JSON with a line for each field, and lists of numbers on one line. Floats are the shortest that read back the same."""
    if isinstance(value, BaseModel):
        value = value.model_dump(mode="json")
    inner = indent + " "
    if isinstance(value, dict) and value:
        fields = [f"{inner}{json.dumps(key)}: {json_text(item, inner)}" for key, item in value.items()]
        return "{\n" + ",\n".join(fields) + f"\n{indent}}}"
    if isinstance(value, (list, tuple)) and any(isinstance(item, dict) for item in value):
        return "[\n" + ",\n".join(inner + json_text(item, inner) for item in value) + f"\n{indent}]"
    return json.dumps(value, allow_nan=False, ensure_ascii=False)


def _reads(method: str, name: str) -> str:
    reads = READS[method]
    return ", ".join(reads[name if name in reads else name.rpartition(".")[0]]) or "-"


def readme(document: Document) -> str:
    """What a port author reads first."""
    conventions = "\n".join(f"- **{name}**: {words}" for name, words in document.conventions.items())
    stages = "\n".join(
        f"| {stage.name} | {stage.shape} {stage.dtype} | {stage.meaning} | {stage.nothing} "
        f"| {_reads(document.method, stage.name)} |"
        for stage in document.expected
        if stage.kind == "result"
    )
    return f"""# {document.name}

{document.about}

Method: {document.method}. Kind: {document.kind}. Meant for the device profile {document.profile}.

`case.json` has the scene, every parameter and all matrices; `inputs/` the arrays that it names; `expected/` what the
reference draws. Draw the scene, write your arrays into a folder under the names of `expected/` (any of them, or
`color.png` alone), and ask `ibr-ref check` for a verdict. A picture of floats that are all k / 255 counts as bytes.

## Conventions

{conventions}

## Expected

| name | shape, dtype | meaning | where nothing is | judged on your |
|---|---|---|---|---|
{stages}

An array is judged on those of yours that it is computed from; one that you do not hand in is made of what it reads in turn,
and at last of the case. Normals and the nine maps, which a case hands over, you may also make yourself and go on with, if
you hand them in.
No case depends on what the APIs leave undefined, such as pow(0, 0) or normalize(0).

## The method

{(_METHODS[document.method].__doc__ or "").strip()}
"""
