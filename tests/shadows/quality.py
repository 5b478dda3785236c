"""How near warped shadows come to rendered ones: `python -m tests.shadows.quality` prints the whole table (half an hour).
`--soft` prints how near few light samples come to the area light instead (ten minutes).

Every object stands on `models.shadow_stage`. Maps: intersection over union at >= 0.5 of the warped and the rendered map,
mean and worst of 64 random offsets. Soft shadows: mean absolute difference, where either is > 0, of the shadow in the
picture for nine light samples, 8 offsets. Area light: the same difference in pictures of 320 x 240, 4 offsets, to rendered
maps of 64 x 64 samples. The cow and the teapot are read from ../shared/data beside the repository.
"""

from __future__ import annotations

import argparse
import itertools
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ibr_ref import models
from ibr_ref.metrics import iou, soft_difference
from ibr_ref.shadows import MapGrid, Maps, Params, Scene, prepare, prepare_grid, render, shadow_maps
from tests.shadows import never_worse, paces
from tests.shadows.casters import cow, teapot

OFFSETS, SOFT_OFFSETS = 64, 8
AREA_OFFSETS, AREA_CELLS = 4, 64
COUNTS = (1, 5, 9, 64, 1024)
"""Light samples that are compared with the area light."""

_BATCH = 64
"""Light samples of a frame: its stages are kept of each."""

Array = NDArray[np.float64]


OBJECTS = {"cow": cow, "teapot": teapot, "chair": models.chair}


def stages(name: str, count: int, width: int = 640, height: int = 480) -> list[Scene]:
    """The object on its stage, at `count` random offsets."""
    scene = models.shadow_stage(OBJECTS[name](), width=width, height=height)
    low, high = np.asarray(scene.offset_range).T
    return [replace(scene, offset=o) for o in np.random.RandomState(64).uniform(low, high, (count, 2))]


def map_quality(scenes: list[Scene], params: Params, maps: Maps | MapGrid | None) -> tuple[float, float]:
    """IoU of the maps with rendered ones, one light sample: mean and worst of all scenes."""
    rendered = replace(params, method="direct")
    found = [iou(shadow_maps(s, params, maps=maps)[0], shadow_maps(s, rendered)[0]) for s in scenes]
    return float(np.mean(found)), min(found)


def soft_quality(scenes: list[Scene], params: Params, maps: Maps | MapGrid | None) -> float:
    """Mean difference of the shadow in the picture from that of rendered maps, the same light samples; of all scenes."""
    rendered = replace(params, method="direct")
    found = [soft_difference(soft_shadow(s, params, maps), soft_shadow(s, rendered)) for s in scenes]
    return float(np.mean(found))


def soft_shadow(
    scene: Scene, params: Params, maps: Maps | MapGrid | None = None, samples: int | Array | None = None
) -> Array:
    """(H, W) the shadow in the picture. samples: any number of light samples, not those of params."""
    if not isinstance(samples, np.ndarray):
        params = params if samples is None else replace(params, light_samples=samples)
        return np.asarray(render(scene, params, maps=maps).stages["accumulate.shadow"])
    total = np.zeros((scene.camera.height, scene.camera.width))
    for first in range(0, len(samples), _BATCH):
        batch = samples[first : first + _BATCH]
        total += len(batch) * soft_shadow(scene, replace(params, light_samples=batch), maps)
    return total / len(samples)


def light_samples(scene: Scene, count: int) -> int | Array:
    """1, 5 and 9 as they are; otherwise the centres (n n, 3) of n x n cells of the light, n n = count."""
    if count in (1, 5, 9):
        return count
    centre, (a, b) = scene.light.arrays
    n = round(count**0.5)
    steps = (2 * np.arange(n) + 1) / n - 1
    return np.array([centre + u * a + v * b for v in steps for u in steps])


def _show(*columns: str) -> None:
    print(*(f"{column:<{width}}" for column, width in zip(columns, (8, 6, 36, 15, 8, 10), strict=True)), flush=True)


def _compare(name: str, size: int) -> None:
    """Maps made beforehand, without a warp."""
    scenes = stages(name, OFFSETS)
    for what, count, mix in (
        ("nearest of nine maps", 3, False),
        ("mix of four of nine", 3, True),
        ("32 x 32 grid, mix of four", 32, True),
    ):
        params = Params(map_size=size, method="grid", grid_size=count, grid_mix=mix)
        mean, worst = map_quality(scenes, params, prepare_grid(scenes[0], params))
        soft = ""
        if size == 256:
            nine = replace(params, light_samples=9)
            soft = f"{soft_quality(scenes[:SOFT_OFFSETS], nine, prepare_grid(scenes[0], nine)):.4f}"
        _show(name, str(size), what, f"{mean:.4f} {worst:.4f}", soft, "")


def _warp(name: str, size: int, quality: str, columns: int, samples: int) -> None:
    """Both policies with the same maps and controls."""
    scenes = stages(name, OFFSETS)
    plain = Params(map_size=size, columns=columns, map_samples=samples)
    nine = replace(plain, light_samples=9)
    start = time.perf_counter()
    maps = prepare(scenes[0], plain, controls=quality)
    seconds = f"{time.perf_counter() - start:.1f} s"
    wide = prepare(scenes[0], nine, controls=quality) if size == 256 else None
    for policy in ("dissolve", "nearest"):
        mean, worst = map_quality(scenes, replace(plain, policy=policy), maps)
        soft = f"{soft_quality(scenes[:SOFT_OFFSETS], replace(nine, policy=policy), wide):.4f}" if wide else ""
        what = f"{quality}, 15 x {columns}, {policy}" + (f", {samples} x {samples} samples" if samples > 1 else "")
        _show(name, str(size), what, f"{mean:.4f} {worst:.4f}", soft, seconds)


def _soft(name: str, size: int) -> None:
    """Few light samples, rendered and warped, against many rendered ones; and warped against the same rendered ones."""
    scenes = stages(name, AREA_OFFSETS, 320, 240)
    rendered = Params(map_size=size, method="direct")
    limits = [soft_shadow(s, rendered, samples=light_samples(s, AREA_CELLS**2)) for s in scenes]
    for count in COUNTS:
        samples = light_samples(scenes[0], count)
        warped = Params(map_size=size, light_samples=samples)
        maps = prepare(scenes[0], warped, controls="best")
        direct = [soft_shadow(s, rendered, samples=samples) for s in scenes]
        ours = [soft_shadow(s, warped, maps, samples) for s in scenes]
        pairs = (direct, limits), (ours, direct), (ours, limits)
        means = [np.mean([soft_difference(a, b) for a, b in zip(*pair, strict=True)]) for pair in pairs]
        print(f"{name:<8} {size:<6} {count:<9}" + "".join(f"{mean:<22.4f}" for mean in means), flush=True)


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(prog="python -m tests.shadows.quality", description=__doc__)
    parser.add_argument("--soft", action="store_true", help="few light samples against the area light")
    parser.add_argument("--never-worse", action="store_true", help='"best" beside simpler ways, in many settings')
    parser.add_argument("--paces", action="store_true", help="the even pace beside the projective one")
    parser.add_argument("--interpolation", default="linear", choices=["linear", "projective"])
    parser.add_argument(
        "--results", type=Path, default=Path("never_worse.jsonl"), help="where --never-worse keeps them"
    )
    parser.add_argument("--part", default="0/1", help="--never-worse: I/N, every N-th setting from the I-th on")
    given = parser.parse_args()
    if given.never_worse:
        first, every = map(int, given.part.split("/"))
        never_worse.run(given.results, given.interpolation, (first, every))
        return
    if given.paces:
        paces.run()
        return
    if given.soft:
        titles = ("rendered to the limit", "warped to rendered", "warped to the limit")
        print(f"{'object':<8} {'size':<6} {'samples':<9}" + "".join(f"{title:<22}" for title in titles))
        for name in OBJECTS:
            _soft(name, 256)
        return
    _show("object", "size", "way", "IoU mean worst", "soft", "prepared")
    for name, size in itertools.product(OBJECTS, (128, 256, 512)):
        _compare(name, size)
        for quality, columns in itertools.product(("fast", "best"), (5, 7)):
            _warp(name, size, quality, columns, 1)
        _warp(name, size, "best", 5, 4)


if __name__ == "__main__":
    main()
