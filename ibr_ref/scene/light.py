"""The light of a scene: one point or one direction, with Phong's coefficients."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.scene import checks
from ibr_ref.scene.vectors import unit


@dataclass(frozen=True, kw_only=True, eq=False)
class Light:
    """A point light, or light from one direction.

    Raises ValueError unless exactly one of `position` and `direction` is given and the numbers are in range.
    """

    position: ArrayLike | None = None
    """(3,) in world space."""
    direction: ArrayLike | None = None
    """(3,) in world space, *towards* the light, of any length but 0."""
    ambient: float = 0.2
    """Ambient coefficient, >= 0."""
    diffuse: float = 0.8
    """Diffuse coefficient, >= 0."""
    specular: float = 0.0
    """Specular coefficient, >= 0."""
    exponent: int = 16
    """Specular exponent, a whole number from 0 to 2^20: raised by repeated squaring. With 0 the highlight is `specular`
    wherever the light falls, also where r.v <= 0; shading languages leave pow(0, 0) undefined, and no case has it."""

    def __post_init__(self) -> None:
        if (self.position is None) == (self.direction is None):
            both = "neither" if self.position is None else "both"
            raise checks.reject("light", f"{both} of position and direction", "exactly one of them")
        name = "direction" if self.position is None else "position"
        vector = checks.vector(name, getattr(self, name))
        if name == "direction" and not vector.any():
            raise checks.reject("direction", vector.tolist(), "a direction that is not zero")
        object.__setattr__(self, name, vector)
        for coefficient in ("ambient", "diffuse", "specular"):
            value = checks.number(coefficient, getattr(self, coefficient), low=0.0)
            object.__setattr__(self, coefficient, value)
        object.__setattr__(self, "exponent", checks.whole("exponent", self.exponent, low=0, high=2**20))

    @property
    def homogeneous(self) -> NDArray[np.float64]:
        """(4,) in world space: (position, 1), or (unit direction, 0)."""
        if self.direction is None:
            return np.append(np.asarray(self.position, np.float64), 1.0)
        return np.append(unit(np.asarray(self.direction, np.float64)), 0.0)
