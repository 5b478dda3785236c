"""A case: a scene that a port is asked to draw, with everything that it needs for that."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from ibr_ref import displacement, shadows, splatting
from ibr_ref.io import Frame
from ibr_ref.scene import checks


@dataclass(frozen=True, kw_only=True, eq=False)
class Case:
    """A scene, its parameters and what else a port is given."""

    name: str
    """"displacement-box": the name of its folder."""
    method: str
    """displacement | splatting | shadows."""
    kind: str
    """easy | typical | adversarial | real-sized."""
    about: str
    """What it tries, in a sentence."""
    profile: str
    """The loosest device profile under which at most 0.5 % of its pixels are undecided."""
    scene: Any
    """The method's Scene."""
    params: Any
    """The method's Params."""
    inputs: dict[str, Any] = field(default_factory=dict)
    """What else is given: "maps" (shadows.Maps), "normals" (uint8 (H, W, 3), one an image, of splatting)."""

    def __post_init__(self) -> None:
        """Raise ValueError for what no referee judges, the systems that the papers compare with, and for a pow(0, 0)."""
        checks.choice("method", self.method, ("displacement", "splatting", "shadows"))
        light = getattr(self.scene, "light", None)
        if getattr(light, "exponent", 1) == 0:
            raise checks.reject("exponent", 0, "1 or more in a case: a port's pow(0, 0) is undefined")
        if self.method == "displacement":
            checks.choice("method", self.params.method, ("protruded",))
        elif self.method == "splatting":
            checks.choice("shape", self.params.shape, ("square", "disc"))
        else:
            checks.choice("method", self.params.method, ("warp", "direct"))

    @cached_property
    def frame(self) -> Frame:
        """What the reference draws, with all stages."""
        return self.draw(stages=True)

    def draw(self, *, stages: bool) -> Frame:
        """What the reference draws; without stages the same picture and depth sooner."""
        if self.method == "displacement":
            return displacement.render(self.scene, self.params, stages=stages)
        if self.method == "splatting":
            return splatting.render(self.scene, self.params, stages=stages)
        return shadows.render(self.scene, self.params, maps=self.inputs.get("maps"), stages=stages)
