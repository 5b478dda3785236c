"""`case.json` and its schema: current, complete, and strict."""

from __future__ import annotations

import json
from dataclasses import fields
from typing import Any, Literal, get_args, get_origin, get_type_hints

import jsonschema
import pytest
from pydantic import BaseModel

import ibr_ref
from ibr_ref import choices, methods
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.schema import adapter, describe, read, schema, schema_text
from ibr_ref.oracle.schema.base import values
from ibr_ref.oracle.schema.displacement import DisplacementParams
from ibr_ref.oracle.schema.shadows import ShadowsParams
from ibr_ref.oracle.schema.splatting import SplattingParams
from ibr_ref.shadows import inputs as shadows_inputs

MODELS = {"displacement": DisplacementParams, "splatting": SplattingParams, "shadows": ShadowsParams}
METHODS = {name: getattr(ibr_ref, name) for name in MODELS}


def written() -> str:
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


def test_the_shipped_schema_is_current() -> None:
    """To the byte. If not: python -m tests.oracle.files.test_schema writes it."""
    assert schema_text() == written()


def test_the_schema_refuses_unknown_fields_everywhere() -> None:
    found = [name for name, part in schema()["$defs"].items() if part.get("type") == "object"]
    assert len(found) > 12
    for name in found:
        assert schema()["$defs"][name]["additionalProperties"] is False, name


COMPARED: dict[str, set[str]] = {
    "displacement": set(),
    "splatting": {"method"},
    "shadows": {"grid_storage", "grid_threshold"},
}
"""Parameters of the systems that the papers compare with: no case has them."""
LATER = {
    "displacement": {"lod_bias", "min_steps", "max_steps", "distance_layers"},
    "splatting": {"footprint", "low_pass", "cutoff", "depth_tolerance"},
    "shadows": {"grid_size", "grid_mix", "search_points", "filter_points"},
}
"""Those that cases of before do not name: they have the defaults."""


@pytest.mark.parametrize("method", METHODS)
def test_every_parameter_is_there(method: str) -> None:
    params = METHODS[method].Params
    assert set(MODELS[method].model_fields) == {field.name for field in fields(params)} - COMPARED[method]
    required = {name for name, field in MODELS[method].model_fields.items() if field.is_required()}
    assert set(MODELS[method].model_fields) - required == LATER.get(method, set())


def test_a_parameter_of_another_system_is_refused() -> None:
    params = ibr_ref.splatting.Params(method="software")
    with pytest.raises(ValueError, match=r"method: found 'software', allowed: 'shader' in a case for ports"):
        values(SplattingParams, params)


@pytest.mark.parametrize(
    ("method", "change"),
    [("displacement", {"method": "exact"}), ("shadows", {"method": "traced"})],
)
def test_no_case_is_made_of_what_no_referee_judges(method: str, change: dict[str, str]) -> None:
    with pytest.raises(ValueError, match=f"{next(iter(change))}: found '{next(iter(change.values()))}', allowed"):
        Case(
            name=f"{method}-x",
            method=method,
            kind="easy",
            about="",
            profile="ieee32",
            scene=None,
            params=METHODS[method].Params(**change),
        )


@pytest.mark.parametrize(
    ("model", "field", "allowed"),
    [
        (DisplacementParams, "interval", choices.INTERVALS),
        (DisplacementParams, "faces", choices.FACES),
        (DisplacementParams, "depth", choices.DEPTHS),
        (DisplacementParams, "method", methods.named("displacement").judged[1]),
        (SplattingParams, "shape", choices.SHAPES),
        (ShadowsParams, "content", choices.CONTENTS),
        (ShadowsParams, "policy", choices.POLICIES),
        (ShadowsParams, "accumulation", shadows_inputs.ACCUMULATIONS),
        (ShadowsParams, "method", choices.SHADOWED_BY),
        (ShadowsParams, "light_samples", shadows_inputs.SAMPLE_COUNTS),
    ],
)
def test_words_are_those_of_the_methods(model: type[BaseModel], field: str, allowed: tuple[Any, ...]) -> None:
    hint: Any = get_type_hints(model)[field]
    literal = hint if get_origin(hint) is Literal else get_args(hint)[0]
    assert get_args(literal) == allowed


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
    text = document.model_dump_json()
    assert adapter().validate_json(text) == document
    assert read(text.encode()) == document


def test_documents_obey_the_schema(case: Case) -> None:
    """As a port author's tools read it."""
    validator = jsonschema.Draft202012Validator(json.loads(schema_text()))
    document = json.loads(describe(case)[0].model_dump_json())
    validator.validate(document)
    document["scene"]["camera"]["zoom"] = 1
    assert not validator.is_valid(document)


if __name__ == "__main__":
    from pathlib import Path

    from ibr_ref.oracle.schema import document as module

    (Path(module.__file__).parent / "case.schema.json").write_text(written(), encoding="utf-8")
