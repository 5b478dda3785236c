"""Scene, Params, render and the contract."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ibr_ref.contract import StageArray
from ibr_ref.io import Frame
from ibr_ref.scene import Camera, checks

STAGES = {"shade.level": StageArray(shape=("H", "W"), dtype="float64", meaning="the level")}


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    camera: Camera
    tint: tuple[float, float, float]
    background: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Params:
    gain: float = 1.0
    kind: str = "linear"

    def __post_init__(self) -> None:
        checks.number("gain", self.gain, low=0.0, high=1.0)
        checks.choice("kind", self.kind, ("linear", "stepped"))


def render(scene: Scene, params: Params, *, stages: bool = True) -> Frame:
    rows, columns = np.mgrid[: scene.camera.height, : scene.camera.width]
    level = params.gain * ((columns + rows) / (scene.camera.width + scene.camera.height))
    color = level[..., None] * np.asarray(scene.tint)
    return Frame(color=color, depth=np.full(level.shape, 0.5), stages={"shade.level": level} if stages else {})
