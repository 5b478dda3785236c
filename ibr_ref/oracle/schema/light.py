"""The light of a scene in `case.json`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ibr_ref.oracle.schema.base import Model, Vector3, Vector4, numbers
from ibr_ref.scene import Light

Coefficient = Annotated[float, Field(ge=0.0)]


class LightFile(Model):
    """Phong's light: exactly one of position and direction is given."""

    position: Vector3 | None
    """World space."""
    direction: Vector3 | None
    """World space, towards the light, of any length."""
    homogeneous: Vector4
    """(position, 1), or (unit direction, 0): what the shaders take."""
    ambient: Coefficient
    diffuse: Coefficient
    specular: Coefficient
    exponent: Annotated[int, Field(ge=1, le=2**20)]
    """Of the specular term, raised by repeated squaring, lowest bit first."""


def describe_light(light: Light) -> LightFile:
    """The light as a document."""
    return LightFile(
        position=None if light.position is None else numbers(light.position),
        direction=None if light.direction is None else numbers(light.direction),
        homogeneous=numbers(light.homogeneous),
        ambient=light.ambient,
        diffuse=light.diffuse,
        specular=light.specular,
        exponent=light.exponent,
    )


def build_light(file: LightFile) -> Light:
    """The light of a document, bit for bit."""
    return Light(**file.model_dump(exclude={"homogeneous"}))
