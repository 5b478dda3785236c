"""`case.json` as a whole: from a case, and back."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, TypeAdapter

import ibr_ref
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.schema import displacement, shadows, splatting
from ibr_ref.oracle.schema.base import ArrayFile, Inputs, Model, Stored
from ibr_ref.oracle.schema.conventions import CONVENTIONS
from ibr_ref.oracle.schema.stages import StageFile, describe_stages
from ibr_ref.scene import checks

FORMAT, VERSION = "ibr_ref case", 1

PLAIN_NAME = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$"


def known_profile(name: str) -> str:
    """A device profile's name."""
    checks.choice("profile", name, tuple(PROFILES))
    return name


Profile = Annotated[str, AfterValidator(known_profile)]


class _Document(Model):
    """What a case is, whatever its method."""

    format: Literal["ibr_ref case"]
    version: Literal[1]
    made_by: str
    """Name and version of what wrote the file."""
    name: str = Field(pattern=PLAIN_NAME)
    """Of the case, and by custom of its folder."""
    kind: Literal["easy", "typical", "adversarial", "real-sized"]
    about: str
    """What it tries."""
    profile: Profile
    """The loosest device profile that it is meant for."""
    conventions: dict[str, str]
    """In words, the same for all cases."""
    expected: tuple[StageFile, ...]
    """The final image and all stages, in order."""


class DisplacementCase(_Document):
    """Protruded displacement mapping (Yoo & Han 2006)."""

    method: Literal["displacement"]
    params: displacement.DisplacementParams
    scene: displacement.DisplacementScene


class SplattingCase(_Document):
    """Splatting of depth images (Lee & Park 2006)."""

    method: Literal["splatting"]
    params: splatting.SplattingParams
    scene: splatting.SplattingScene


class ShadowsCase(_Document):
    """Shadows by image warping (Kang & Ihm 2002)."""

    method: Literal["shadows"]
    params: shadows.ShadowsParams
    scene: shadows.ShadowsScene


Document = DisplacementCase | SplattingCase | ShadowsCase

ADAPTER: TypeAdapter[Document] = TypeAdapter(Annotated[Document, Field(discriminator="method")])

_INPUTS: dict[str, tuple[str, ...]] = {"displacement": (), "splatting": ("normals",), "shadows": ("maps",)}
"""What a case may be given besides scene and parameters."""


def schema() -> dict[str, Any]:
    """The JSON Schema of `case.json`."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": FORMAT, **ADAPTER.json_schema()}


def schema_text() -> str:
    """The same as it is shipped, in `case.schema.json` beside this module."""
    return (Path(__file__).parent / "case.schema.json").read_text(encoding="utf-8")


def describe(case: Case) -> tuple[Document, Inputs]:
    """The case as a document, and the arrays that it is given; renders the case.

    Raises ValueError for a case that cannot be written down: an unknown method, kind or profile, a name that is not
    plain, inputs that are missing or not known.
    """
    document, inputs = describe_inputs(case)
    values = {name: getattr(document, name) for name in type(document).model_fields}
    return type(document)(**{**values, "expected": describe_stages(case.method, case.frame)}), inputs


def describe_inputs(case: Case) -> tuple[Document, Inputs]:
    """The same without what is expected, and without rendering."""
    checks.choice("method", case.method, tuple(_INPUTS))
    unknown = sorted(set(case.inputs) - set(_INPUTS[case.method]))
    if unknown:
        raise checks.reject("inputs", unknown[0], f"{', '.join(_INPUTS[case.method]) or 'none'} (of {case.method})")
    inputs = Inputs()
    shared: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "made_by": f"ibr_ref {ibr_ref.__version__}",
        "name": case.name,
        "kind": case.kind,
        "about": case.about,
        "profile": case.profile,
        "conventions": CONVENTIONS,
        "expected": (),
    }
    if case.method == "displacement":
        return (
            DisplacementCase(
                **shared,
                method="displacement",
                params=displacement.describe_params(case.params),
                scene=displacement.describe_scene(case.scene, inputs),
            ),
            inputs,
        )
    if case.method == "splatting":
        given = case.inputs.get("normals")
        return (
            SplattingCase(
                **shared,
                method="splatting",
                params=splatting.describe_params(case.params),
                scene=splatting.describe_scene(case.scene, given, inputs),
            ),
            inputs,
        )
    maps = case.inputs.get("maps")
    return (
        ShadowsCase(
            **shared,
            method="shadows",
            params=shadows.describe_params(case.params),
            scene=shadows.describe_scene(case.scene, case.params, maps, inputs),
        ),
        inputs,
    )


def build(document: Document, stored: Stored) -> Case:
    """The case of a document and its arrays, by the names of their files. Raises ValueError for what is no scene."""
    shared: dict[str, Any] = {name: getattr(document, name) for name in ("name", "method", "kind", "about", "profile")}
    if isinstance(document, DisplacementCase):
        scene: Any = displacement.build_scene(document.scene, stored)
        return Case(**shared, scene=scene, params=displacement.build_params(document.params))
    if isinstance(document, SplattingCase):
        scene, normals = splatting.build_scene(document.scene, stored)
        return Case(**shared, scene=scene, params=splatting.build_params(document.params), inputs={"normals": normals})
    scene, maps = shadows.build_scene(document.scene, stored)
    inputs = {} if maps is None else {"maps": maps}
    return Case(**shared, scene=scene, params=shadows.build_params(document.params), inputs=inputs)


def input_files(part: Any) -> list[ArrayFile]:
    """All arrays that a document, or a part of it, says are given."""
    if isinstance(part, ArrayFile):
        return [part]
    if isinstance(part, Model):
        return [file for name in type(part).model_fields for file in input_files(getattr(part, name))]
    return [file for item in part for file in input_files(item)] if isinstance(part, tuple) else []
