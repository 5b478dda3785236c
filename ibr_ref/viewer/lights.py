"""Knobs of a scene's light."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ibr_ref.scene import Light
from ibr_ref.scene.limits import Real, Whole
from ibr_ref.viewer.knobs import Knob

_AZIMUTH, _ELEVATION = "light_azimuth", "light_elevation"


def knobs(light: Light) -> dict[str, Knob]:
    """Where it comes from, if from one direction, and its coefficients."""
    found = {}
    if light.direction is not None:
        azimuth, elevation = _angles(light)
        found[_AZIMUTH] = Knob(Real(low=-180.0, high=180.0), azimuth, "Degrees about z, from x towards y.")
        found[_ELEVATION] = Knob(Real(low=-90.0, high=90.0), elevation, "Degrees above the plane of x and y.")
    for name in ("ambient", "diffuse", "specular"):
        found[name] = Knob(Real(low=0.0, high=2.0), getattr(light, name), "Coefficient of the light.")
    found["exponent"] = Knob(Whole(0, 256), light.exponent, "Of the highlight.")
    return found


def changed(light: Light, values: Mapping[str, Any]) -> Light:
    """With those of these knobs that are the light's."""
    fields = {name: values[name] for name in ("ambient", "diffuse", "specular", "exponent") if name in values}
    if _AZIMUTH in values or _ELEVATION in values:
        azimuth, elevation = _angles(light)
        a = math.radians(values.get(_AZIMUTH, azimuth))
        e = math.radians(values.get(_ELEVATION, elevation))
        fields["direction"] = (math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e))
    return replace(light, **fields) if fields else light


def _angles(light: Light) -> tuple[float, float]:
    """Azimuth and elevation in degrees, to a tenth."""
    x, y, z = np.asarray(light.direction, np.float64).tolist()
    return round(math.degrees(math.atan2(y, x)), 1), round(math.degrees(math.atan2(z, math.hypot(x, y))), 1)
