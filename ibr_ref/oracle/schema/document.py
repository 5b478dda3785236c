"""`case.json` as a whole: from a case, and back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, reduce
from operator import or_
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Field, TypeAdapter
from pydantic_core import from_json

import ibr_ref
from ibr_ref import methods
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import PROFILES, profile_of
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


class Document(Model):
    """What a case is, whatever its method: each adds `method`, `params` and `scene`."""

    format: Literal["ibr_ref case"]
    version: Literal[1]
    made_by: str
    """Name and version of what wrote the file."""
    name: str = Field(pattern=PLAIN_NAME)
    """Of the case, and by custom of its folder."""
    kind: Literal["easy", "typical", "adversarial", "real-sized", "own"]
    about: str
    """What it tries."""
    profile: Profile
    """The loosest device profile that it is meant for."""
    conventions: dict[str, str]
    """In words, the same for all cases."""
    expected: tuple[StageFile, ...]
    """The final image and all stages, in order."""

    if TYPE_CHECKING:  # to pydantic they are fields of each method's own model, in its own types
        method: str
        params: Any
        scene: Any


@dataclass(frozen=True, kw_only=True)
class Schema:
    """A method in `case.json`: what `methods.Method.schema` names."""

    document: type[Document]
    describe: Callable[[Case, Inputs], tuple[Any, Any]]
    """`params` and `scene` of the document; the case's arrays go into the inputs. Raises ValueError for what cannot be
    written down."""
    build: Callable[[Any, Stored], tuple[Any, Any, dict[str, Any]]]
    """Scene, parameters and `Case.inputs` of such a document. Raises ValueError for what is no scene."""
    features: Callable[[Any], set[str]] = lambda document: set()
    """Of such a document: which marked sections of the method's page (`pages`) its README has."""
    most_faces: Callable[[Any], dict[str, int]] = lambda scene: {}
    """Of a scene's arrays that have four rows a face: how many faces a port may hand in, right or not."""


def schema_of(method: str) -> Schema:
    """That of a method."""
    found: Schema = methods.named(method).schema.open()
    return found


def read(data: bytes) -> Document:
    """`case.json`, checked by the model of its method alone: whoever reads one case need not import all methods.

    Raises pydantic.ValidationError.
    """
    try:
        found = from_json(data)["method"]
    except (ValueError, TypeError, KeyError):
        found = None  # which the adapter of all says better
    if found not in methods.names():
        return adapter().validate_json(data)
    document: Document = schema_of(found).document.model_validate_json(data)
    return document


def adapter() -> TypeAdapter[Document]:
    """What describes `case.json`, of any method."""
    return _adapter(methods.records())


@cache
def _adapter(records: tuple[methods.Method, ...]) -> TypeAdapter[Document]:
    documents: Any = reduce(or_, (method.schema.open().document for method in records))
    return TypeAdapter(Annotated[documents, Field(discriminator="method")])


def schema() -> dict[str, Any]:
    """The JSON Schema of `case.json`."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": FORMAT, **adapter().json_schema()}


def schema_text() -> str:
    """The same of this package's own methods, as it is shipped, in `case.schema.json` beside this module."""
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
    known = methods.named(case.method).inputs
    unknown = sorted(set(case.inputs) - set(known))
    if unknown:
        raise checks.reject("inputs", unknown[0], f"{', '.join(known) or 'none'} (of {case.method})")
    inputs = Inputs()
    method = schema_of(case.method)
    params, scene = method.describe(case, inputs)
    fields: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "made_by": f"ibr_ref {ibr_ref.__version__}",
        "name": case.name,
        "kind": case.kind,
        "about": case.about,
        "profile": case.profile or profile_of(case.undecided),
        "conventions": CONVENTIONS,
        "expected": (),
        "method": case.method,
        "params": params,
        "scene": scene,
    }
    return method.document(**fields), inputs


def build(document: Document, stored: Stored) -> Case:
    """The case of a document and its arrays, by the names of their files. Raises ValueError for what is no scene."""
    shared: dict[str, Any] = {name: getattr(document, name) for name in ("name", "method", "kind", "about", "profile")}
    scene, params, inputs = schema_of(document.method).build(document, stored)
    return Case(**shared, scene=scene, params=params, inputs=inputs)


def input_files(part: Any) -> list[ArrayFile]:
    """All arrays that a document, or a part of it, says are given."""
    if isinstance(part, ArrayFile):
        return [part]
    if isinstance(part, Model):
        return [file for name in type(part).model_fields for file in input_files(getattr(part, name))]
    return [file for item in part for file in input_files(item)] if isinstance(part, tuple) else []
