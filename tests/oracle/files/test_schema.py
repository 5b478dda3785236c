"""`case.json` and its schema: current, complete, and strict."""

from __future__ import annotations

import json
import re
from dataclasses import fields
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest
from pydantic import BaseModel

import ibr_ref
from ibr_ref.displacement import inputs as displacement_inputs
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.schema import ADAPTER, describe, schema, schema_text
from ibr_ref.oracle.schema.displacement import DisplacementParams
from ibr_ref.oracle.schema.shadows import ShadowsParams
from ibr_ref.oracle.schema.splatting import SplattingParams
from ibr_ref.oracle.schema.stages import CONTRACTS
from ibr_ref.shadows import inputs as shadows_inputs
from ibr_ref.splatting import inputs as splatting_inputs

MODELS = {"displacement": DisplacementParams, "splatting": SplattingParams, "shadows": ShadowsParams}
METHODS = {name: getattr(ibr_ref, name) for name in MODELS}


def test_the_shipped_schema_is_current() -> None:
    """If not: python -m tests.oracle.files.test_schema writes it."""
    assert json.loads(schema_text()) == json.loads(json.dumps(schema()))


def test_the_schema_refuses_unknown_fields_everywhere() -> None:
    found = [name for name, part in schema()["$defs"].items() if part.get("type") == "object"]
    assert len(found) > 12
    for name in found:
        assert schema()["$defs"][name]["additionalProperties"] is False, name


@pytest.mark.parametrize("method", METHODS)
def test_every_parameter_is_there(method: str) -> None:
    params = METHODS[method].Params
    assert set(MODELS[method].model_fields) == {field.name for field in fields(params)}
    assert all(field.is_required() for field in MODELS[method].model_fields.values())


@pytest.mark.parametrize(
    ("model", "field", "allowed"),
    [
        (DisplacementParams, "interval", displacement_inputs.INTERVALS),
        (DisplacementParams, "faces", displacement_inputs.FACES),
        (DisplacementParams, "depth", displacement_inputs.DEPTHS),
        (DisplacementParams, "method", displacement_inputs.METHODS),
        (SplattingParams, "shape", splatting_inputs.SHAPES),
        (ShadowsParams, "content", shadows_inputs.CONTENTS),
        (ShadowsParams, "policy", shadows_inputs.POLICIES),
        (ShadowsParams, "accumulation", shadows_inputs.ACCUMULATIONS),
        (ShadowsParams, "method", shadows_inputs.METHODS),
        (ShadowsParams, "grid_storage", shadows_inputs.STORAGES),
        (ShadowsParams, "light_samples", shadows_inputs.SAMPLE_COUNTS),
    ],
)
def test_words_are_those_of_the_methods(model: type[BaseModel], field: str, allowed: tuple[Any, ...]) -> None:
    hint: Any = get_type_hints(model)[field]
    literal = hint if get_origin(hint) is Literal else get_args(hint)[0]
    assert get_args(literal) == allowed


@pytest.mark.parametrize("method", METHODS)
def test_every_stage_of_the_documentation_has_its_meaning(method: str) -> None:
    documented = re.findall(r"^\| ([a-z]+(?:\.[a-z_]+)?) \|", METHODS[method].__doc__, re.MULTILINE)
    assert list(CONTRACTS[method]) == [name for name in documented if name != "name"]


def test_every_stage_of_a_frame_is_described(case: Case) -> None:
    document, _ = describe(case)
    names = [stage.name for stage in document.expected]
    assert len(set(names)) == len(names)
    assert names[:2] == ["color", "depth"]
    for stage in document.expected:
        assert stage.meaning
        assert stage.kind == ("margin" if "margin" in stage.name else "result")
        assert stage.group == (
            "image" if "." not in stage.name and stage.name != "controls" else stage.name.split(".")[0]
        )


def test_a_document_is_what_it_reads_back(case: Case) -> None:
    document, _ = describe(case)
    assert ADAPTER.validate_json(document.model_dump_json()) == document


if __name__ == "__main__":
    from pathlib import Path

    from ibr_ref.oracle.schema import document as module

    text = json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"
    (Path(module.__file__).parent / "case.schema.json").write_text(text, encoding="utf-8")
