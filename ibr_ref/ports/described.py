"""Scenes of the package as the ports take them: as if they had been exported and read again."""

from __future__ import annotations

from typing import Any

from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.schema import describe_inputs
from ibr_ref.ports.case_folder import GivenCase, given_case


def described(method: str, scene: Any, params: Any, **inputs: Any) -> GivenCase:
    """A scene and its parameters; inputs: maps of shadows, normals of splatting."""
    case = Case(
        name="described",
        method=method,
        kind="typical",
        about="",
        profile="gl",
        scene=scene,
        params=params,
        inputs=inputs,
    )
    document, files = describe_inputs(case)
    return given_case(document.model_dump(mode="json"), files.arrays.__getitem__)
