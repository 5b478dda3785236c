"""Whether `controls="best"` is never behind simpler ways: `python -m tests.shadows.quality --never-worse`.

Every caster under every light, in every range, with maps of every size: intersection over union at >= 0.5 of the map with
the rendered one, mean and worst of 24 random offsets, which are not those that `prepare` chooses by. Every setting is kept
in a file as it is done, so that what was broken off goes on.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ibr_ref import models
from ibr_ref.metrics import iou
from ibr_ref.scene import AreaLight
from ibr_ref.shadows import Params, Scene, prepare, prepare_grid, shadow_maps
from tests.shadows.casters import CASTERS

LIGHTS = {
    "aside": ((-1.0, -1.2, 5.0), 27.0),
    "overhead": ((0.3, 0.2, 5.0), 50.0),
    "slanting": ((-3.0, -2.0, 3.0), 40.0),
}
"""Position, and field of view in degrees; each looks at the origin."""
RANGES = (0.6, 0.05, 0.001)
SIZES = (64, 128, 256)
OFFSETS = 24
RIVALS = ("fast", "bounds", "identity", "nearest")

Setting = tuple[str, str, float, int]


def settings() -> list[Setting]:
    """(caster, light, range, S) of all, so mixed that a part of them has some of each."""
    found = list(itertools.product(CASTERS, LIGHTS, RANGES, SIZES))
    return [found[number * 100 % len(found)] for number in range(len(found))]


def stages(caster: str, light: str, reach: float, count: int = OFFSETS) -> list[Scene]:
    """The caster on the stage at `count` random offsets of -reach to reach."""
    position, field_of_view = LIGHTS[light]
    lamp = AreaLight(
        position=position, target=(0.0, 0.0, 0.0), up=(0.0, 1.0, 0.0), vertical_fov=field_of_view, near=0.5, far=12.0,
        half_edges=((0.1, 0.0, 0.0), (0.0, 0.1, 0.0)),
    )  # fmt: skip
    stage = models.shadow_stage(CASTERS[caster](), width=16, height=12)
    stage = replace(stage, light=lamp, offset_range=((-reach, reach), (-reach, reach)))
    return [replace(stage, offset=o) for o in np.random.RandomState(24).uniform(-reach, reach, (count, 2))]


def measure(setting: Setting, interpolation: str = "linear", count: int = OFFSETS) -> dict[str, Any]:
    """Mean and worst of each way, and what `best` and `fast` took."""
    caster, light, reach, size = setting
    scenes = stages(caster, light, reach, count)
    plain = Params(map_size=size, interpolation=interpolation)
    direct = replace(plain, method="direct")
    nine = replace(plain, method="grid", grid_size=3, grid_mix=False)
    truths = [shadow_maps(scene, direct)[0] for scene in scenes]
    ways: dict[str, Any] = {"nearest": (nine, prepare_grid(scenes[0], nine))}
    ways |= {name: (plain, prepare(scenes[0], plain, controls=name)) for name in ("best", "fast", "bounds", "identity")}
    figures: dict[str, Any] = {}
    for name, (params, maps) in ways.items():
        found = [iou(shadow_maps(s, params, maps=maps)[0], t) for s, t in zip(scenes, truths, strict=True)]
        figures[name] = [float(np.mean(found)), min(found)]
        if name in ("best", "fast"):
            figures[f"{name} took"] = maps.choice.chosen
    return figures


def behind(figures: dict[str, Any]) -> list[tuple[str, str, float]]:
    """Where `best` is behind: the way, "mean" or "worst", and by how much."""
    return [
        (name, what, figures[name][k] - figures["best"][k])
        for name in RIVALS
        for k, what in enumerate(("mean", "worst"))
        if figures[name][k] > figures["best"][k]
    ]


def run(path: Path, interpolation: str, part: tuple[int, int]) -> None:
    """Measure what the file lacks, of every `part[1]`-th setting from `part[0]` on; print the table of all it holds."""
    done = _read(path)
    for number, setting in enumerate(settings()):
        key = "/".join(map(str, (*setting, interpolation)))
        if key in done or number % part[1] != part[0]:
            continue
        done[key] = measure(setting, interpolation)
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"setting": key, **done[key]}) + "\n")
        print(key, done[key]["best"], behind(done[key]), flush=True)
    print(table({key: value for key, value in done.items() if key.endswith(interpolation)}))


def _read(path: Path) -> dict[str, dict[str, Any]]:
    if not path.exists():
        return {}
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    return {line.pop("setting"): line for line in lines}


def table(done: dict[str, dict[str, Any]]) -> str:
    """A row for each caster and light, a column for each range and size: `best`, and how far it is ahead; what is behind."""
    lines = [*_rows(done, _reached), "", *_rows(done, _ahead), ""]
    for key, figures in done.items():
        for name, what, by in behind(figures):
            k = 0 if what == "mean" else 1
            lines.append(f"- {key}: {what} {figures['best'][k]:.4f}, {name} {figures[name][k]:.4f} (by {by:.4f})")
    lines.append(f"{len(done)} of {len(settings())} settings, behind in {sum(bool(behind(v)) for v in done.values())}")
    return "\n".join(lines)


def _rows(done: dict[str, dict[str, Any]], cell: Callable[[dict[str, Any]], str]) -> list[str]:
    columns = [*itertools.product(RANGES, SIZES)]
    lines = [
        "| caster, light | " + " | ".join(f"{reach:g}, {size}" for reach, size in columns) + " |",
        "|---|" + "---|" * len(columns),
    ]
    by_setting = {tuple(key.split("/")[:4]): figures for key, figures in done.items()}
    for caster, light in itertools.product(CASTERS, LIGHTS):
        found = [by_setting.get((caster, light, str(reach), str(size))) for reach, size in columns]
        if any(found):
            cells = ["" if figures is None else cell(figures) for figures in found]
            lines.append(f"| {caster}, {light} | {' | '.join(cells)} |")
    return lines


def _reached(figures: dict[str, Any]) -> str:
    """Mean / worst of `best`."""
    mean, worst = figures["best"]
    return f"{_short(mean)} / {_short(worst)}"


def _ahead(figures: dict[str, Any]) -> str:
    """How far `best` is ahead of the best of the others, in the mean / at worst."""
    by = [figures["best"][k] - max(figures[name][k] for name in RIVALS) for k in range(2)]
    return " / ".join(_short(difference) for difference in by)


def _short(number: float) -> str:
    return f"{number:.3f}".replace("0.", ".")
