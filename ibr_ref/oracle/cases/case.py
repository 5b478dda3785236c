"""A case: a scene that a port is asked to draw, with everything that it needs for that."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from functools import cached_property
from inspect import signature
from typing import Any

from ibr_ref import methods
from ibr_ref.io import Frame
from ibr_ref.scene import checks


@dataclass(frozen=True, kw_only=True, eq=False)
class Case:
    """A scene, its parameters and what else a port is given."""

    scene: Any
    """The method's Scene."""
    params: Any
    """The method's Params."""
    name: str = ""
    """"displacement-box": the name of its folder. Without: METHOD-own."""
    method: str = ""
    """The name of its record in `ibr_ref.methods`. Without: that of the scene."""
    kind: str = "own"
    """easy | typical | adversarial | real-sized, or own."""
    about: str = ""
    """What it tries, in a sentence."""
    profile: str = ""
    """The loosest device profile under which at most 0.5 % of its pixels are undecided. Without: measured when the case is
    written down, from `undecided`."""
    inputs: dict[str, Any] = field(default_factory=dict)
    """What else is given, as the method's record names it: "maps" (shadows.Maps), "normals" (of splatting: uint8 (H, W, 3),
    one an image)."""
    kept: dict[str, Any] = field(default_factory=dict, init=False, repr=False)
    """What referees made of it and want again, by a name of theirs; it may refer to the case, and goes with it."""

    def __post_init__(self) -> None:
        """Raise ValueError for what no referee judges, the systems that the papers compare with, and for a pow(0, 0)."""
        object.__setattr__(self, "method", self.method or method_of(self.scene))
        object.__setattr__(self, "name", self.name or f"{self.method}-own")
        checks.choice("method", self.method, methods.names())
        light = getattr(self.scene, "light", None)
        if getattr(light, "exponent", 1) == 0:
            raise checks.reject("exponent", 0, "1 or more in a case: a port's pow(0, 0) is undefined")
        field, judged = methods.named(self.method).judged
        checks.choice(field, getattr(self.params, field), judged)

    def __getstate__(self) -> dict[str, Any]:
        """Without what referees keep: another process makes its own."""
        return {**vars(self), "kept": {}}

    @cached_property
    def frame(self) -> Frame:
        """What the reference draws, with all stages."""
        return self.draw(stages=True)

    @cached_property
    def undecided(self) -> dict[str, float]:
        """Share of its pixels at which a right port may show something else, by device profile; takes five judgements."""
        from ibr_ref.oracle import power  # here: whoever makes cases needs no referee

        return power.undecided(self)

    @property
    def system(self) -> str:
        """Which of those that its method's referee judges."""
        return str(getattr(self.params, methods.named(self.method).judged[0]))

    def draw(self, *, stages: bool) -> Frame:
        """What the reference draws; without stages the same picture and depth sooner."""
        render = methods.named(self.method).package.open().render
        given = {name: value for name, value in self.inputs.items() if name in signature(render).parameters}
        frame: Frame = render(self.scene, self.params, stages=stages, **given)
        return frame


def method_of(scene: Any) -> str:
    """The method whose Scene it is; of those that are imported, as that of a scene is."""
    for method in methods.records():
        if method.package.partition(":")[0] in sys.modules and isinstance(scene, method.package.open().Scene):
            return method.name
    raise checks.reject("scene", type(scene).__name__, f"a Scene of {' | '.join(methods.names())}")
