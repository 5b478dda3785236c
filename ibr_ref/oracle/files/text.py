"""The text of the documents of a case's folder."""

from __future__ import annotations

import json
from typing import Any

from pydantic import BaseModel

from ibr_ref.contract import described, spelled
from ibr_ref.oracle.declaration import NUMBERS as DECLARED
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.files.features import features
from ibr_ref.oracle.files.fields import field_list, input_table
from ibr_ref.oracle.referees.reads import reads_of, system_of
from ibr_ref.oracle.schema import Document
from ibr_ref.oracle.schema.stages import contract_of
from ibr_ref.pages import excerpt


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


def _reads(document: Document, name: str) -> str:
    """Those that the case has: a map that is rendered directly is made of no grid."""
    reads = reads_of(document.method, system_of(document.method, document.params))
    there = {stage.name for stage in document.expected} | {stage.name.rpartition(".")[0] for stage in document.expected}
    return ", ".join(one for one in reads[name if name in reads else name.rpartition(".")[0]] if one in there) or "-"


def readme(document: Document) -> str:
    """What a port author reads first, and all that a port of this case can be written from."""
    used = features(document)
    return f"""# {document.name}

{document.about}

Method: {document.method}. Kind: {document.kind}. Meant for the device profile {document.profile}.

`case.json` has the scene, every parameter and all matrices; `inputs/` the arrays that it names; `expected/` what the
reference draws. This page says what they mean, and the part of the method that this case needs; the whole of it is
printed by `ibr-ref method {document.method}`.

## Handing in

Draw the scene, write your arrays into a folder under the names of `expected/` (any of them, or `color.png` alone), and
ask for a verdict: `ibr-ref check CASE_FOLDER YOUR_FOLDER`. {_HANDING_IN}

## case.json

{field_list(document)}

## Inputs

"k / 255": the file holds bytes k, and the value is k / 255, as a UNORM texture gives it. "as stored": the numbers
themselves.

| file | shape, dtype | value | meaning |
|---|---|---|---|
{input_table(document)}

## Expected

{_expected(document)}

{excerpt("conventions", used, deeper=1)}
{excerpt(document.method, used, deeper=1)}"""


_HANDING_IN = """Shapes are those of `expected`; `color` may have a fourth
channel, which is not looked at. A picture of floats that are all k / 255 counts as bytes.

Every stage is judged on your own arrays of the stages before it, so hand in as many as you have: the verdict then names the
first stage that is wrong. A decision (a comparison in the search, a depth test, an edge) may go either way where rounding on
the device can turn it, and nowhere else. `port.json` may declare the device, `{"profile": "vulkan"}`, one of
NAMES, from the tightest to the loosest, and what it is asked for besides, such as
`{"profile": "gl", "subpixel_bits": 4}`: NUMBERS. Without, the tightest one that explains
everything is looked for.""".replace("NAMES", ", ".join(PROFILES)).replace("NUMBERS", ", ".join(DECLARED))


_JUDGED_ON = """An array is judged on those of yours that it is computed from; one that you do not hand in is made of what it
reads in turn, and at last of the case. Normals and the nine maps, which a case hands over, you may also make yourself and go
on with, if you hand them in, beside a picture too: without them it is judged with those of the case. No case depends on what
the APIs leave undefined, such as pow(0, 0) or normalize(0).

To try one stage alone, before the others are written, feed it with the arrays of `expected/` that it is judged on, draw, and
hand in its arrays and those: they are right, so that the verdict is on your stage."""


def _expected(document: Document) -> str:
    """The table of the results, and the names of the margins."""
    results = [stage for stage in document.expected if stage.kind == "result"]
    margins = [f"`{stage.name}`" for stage in document.expected if stage.kind == "margin"]
    contract = contract_of(document.method)
    left = {stage.name: spelled(described(contract, stage.name).discarded) for stage in results}
    more = any(left.values())
    lines = [
        f"| name | shape, dtype | meaning | where nothing is |{' where discarded |' if more else ''} judged on your |",
        f"|---|---|---|---|{'---|' if more else ''}---|",
    ]
    for stage in results:
        cells = f"| {stage.name} | {stage.shape} {stage.dtype} | {stage.meaning} | {stage.nothing} |"
        lines.append(cells + (f" {left[stage.name] or '-'} |" if more else "") + f" {_reads(document, stage.name)} |")
    if more:
        lines += ["", '"own": a discarded fragment or point leaves there what any other has.']
    lines += ["", _JUDGED_ON]
    if margins:
        known = "How close the reference's decisions were, and what they cost, which you need not hand in"
        lines += ["", f"{known}: {', '.join(margins)}."]
    return "\n".join(lines)
