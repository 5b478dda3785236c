"""Shadows by image warping: the GLSL port on this machine's OpenGL beside the package.

Run `python -m ibr_ref.bench.beside_glsl.shadows [BLOCKS]`. Maps of 512 x 512, 15 x 5 control points, a
picture of 640 x 480; the caster is the cow of `../shared/data` where it is there, else the horse: 5,804 triangles either
way. Contenders take turns in blocks of consecutive frames, the first of which do not count: each is measured with its own
caches warm, all under the same states of the machine. A GL frame is submission and glFinish, without read-back, the nine
maps uploaded before, as bytes and as 32-bit floats. The package's maps are float64.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import ibr_ref
from ibr_ref import io, models, shadows
from ibr_ref.bench.beside_glsl.splatting import BLOCKS, COUNTED, WARM_UP, in_blocks
from ibr_ref.ports.described import described
from ibr_ref.ports.glsl.shadows import Port
from ibr_ref.shadows.prepared import depths_of, texels_at, view_of
from ibr_ref.shadows.samples import samples_of, seen_offset
from ibr_ref.shadows.warp import locate, warp_stage

COW = Path(__file__).resolve().parents[4] / "shared" / "data" / "models" / "cow.obj"
PARAMS = shadows.Params(map_size=512, rows=15, columns=5)
WANTED = {"warped, nearest": 3.0, "warped, dissolve": 6.0, "nine warped, dissolve": 54.0, "rendered": 3.0}
"""Best times in ms that the package is to keep, and to be no slower than GLSL."""

WANTED_SHARE = {"rendered": 0.8}
"""Best time of the package at most, as a share of GLSL's best."""

Contenders = dict[str, Callable[[], float]]


def main() -> None:
    """Measure and print the tables."""
    blocks = int(sys.argv[1]) if len(sys.argv) > 1 else BLOCKS
    port = Port()
    name, scene = pictured()
    print(f"GL_RENDERER: {port.device.renderer}; {os.cpu_count()} CPUs")
    print(
        f"{name}: {len(np.asarray(scene.caster.triangles)):,} triangles; {PARAMS.rows} x {PARAMS.columns} control points"
    )
    print(f"{blocks} blocks of {COUNTED} frames each after {WARM_UP} that do not count")
    soft = replace(PARAMS, light_samples=9)
    maps = {1: shadows.prepare(scene, PARAMS), 9: shadows.prepare(scene, soft)}
    direct = replace(PARAMS, method="direct")
    measure("warped, nearest", port, scene, replace(PARAMS, policy="nearest"), maps[1], blocks)
    measure("warped, dissolve", port, scene, PARAMS, maps[1], blocks)
    measure("nine warped, dissolve", port, scene, soft, maps[9], blocks)
    measure("rendered", port, scene, direct, None, blocks)
    measure("frame of nine warped, dissolve", port, scene, soft, maps[9], blocks, whole=True)
    compare(port, scene, soft, maps[9])


def pictured() -> tuple[str, shadows.Scene]:
    """A name, and the caster over a floor under a spot light."""
    name, caster = ("cow", io.read_mesh(COW)) if COW.exists() else ("horse", models.horse())
    vertices, (low, high) = np.asarray(caster.vertices), caster.bounds
    size = float((high - low).max())
    caster = ibr_ref.Mesh(
        vertices=(vertices - (low + high) / 2) / size, triangles=caster.triangles, color=(0.8, 0.5, 0.3)
    )
    floor = [(-2.0, -2.0, -0.6), (2.0, -2.0, -0.6), (2.0, 2.0, -0.6), (-2.0, 2.0, -0.6)]
    edges = ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0))
    light = shadows.AreaLight(position=(0, 0, 2.5), target=(0, 0, 0), near=0.5, far=6.0, half_edges=edges)
    camera = ibr_ref.Camera.look_at(
        eye=(0, -2.8, 1.8), target=(0, 0, -0.3), up=(0, 0, 1), vertical_fov=45, near=0.1, far=20, width=640, height=480
    )
    return name, shadows.Scene(
        receivers=[ibr_ref.Mesh(vertices=floor, triangles=[(0, 1, 2), (0, 2, 3)], color=(0.8, 0.8, 0.7))],
        caster=caster,
        offset_range=((-0.3, 0.3), (-0.3, 0.3)),
        offset=(0.11, 0.07),
        light=light,
        camera=camera,
    )


def measure(
    title: str,
    port: Port,
    scene: shadows.Scene,
    params: shadows.Params,
    maps: shadows.Maps | None,
    blocks: int,
    *,
    whole: bool = False,
) -> None:
    """Print the rows of one pass: the maps of all light samples, or the whole frame."""
    kinds = {"GLSL": "f1"} if maps is None else {"GLSL, bytes": "f1", "GLSL, floats": "f4"}
    given = exported(scene, params, maps)
    prepared = {name: port.prepare(given, params, stages=False, texels=texels) for name, texels in kinds.items()}
    contenders: Contenders = {name: each.seconds if whole else each.map_seconds for name, each in prepared.items()}
    if whole:
        contenders["ibr_ref"] = timed(lambda: shadows.render(scene, params, maps=maps, stages=False))
    else:
        contenders["ibr_ref"] = timed(lambda: package_maps(scene, params, maps))
    seconds = in_blocks(contenders, blocks)
    limit = f"; wanted of ibr_ref: {WANTED[title]:g} ms" if title in WANTED else ""
    print(f"\n{title + limit:60}{'best ms':>9}{'median ms':>11}{'share of the last':>21}")
    for name, times in seconds.items():
        best, median = 1e3 * min(times), 1e3 * float(np.median(times))
        print(f"{name:60}{best:9.2f}{median:11.2f}{best / (1e3 * min(seconds['ibr_ref'])):20.2f}x")
    share = min(seconds["ibr_ref"]) / min(min(times) for name, times in seconds.items() if name != "ibr_ref")
    wanted = f", wanted: {WANTED_SHARE[title]:g} at most" if title in WANTED_SHARE else ""
    print(f"ibr_ref takes {share:.2f} of the faster GLSL{wanted}")
    for each in prepared.values():
        each.release()


def exported(scene: shadows.Scene, params: shadows.Params, maps: shadows.Maps | None) -> Any:
    """The scene as the port takes it."""
    return described("shadows", scene, params, **({} if maps is None else {"maps": maps})).scene


def package_maps(scene: shadows.Scene, params: shadows.Params, maps: shadows.Maps | None) -> list[np.ndarray]:
    """The maps of all light samples, as a frame makes them."""
    images = []
    for sample in samples_of(scene, params):
        if maps is None:
            images.append(texels_at(view_of(scene, params.map_size, sample.position), np.asarray(scene.offset), params))
        else:
            cell, fraction = locate(maps.positions, seen_offset(scene, sample))
            nearest = params.policy == "nearest"
            warped = warp_stage(maps.nine, cell, fraction, depths_of(scene, params, maps.positions), nearest)
            images.append(warped.image)
    return images


def timed(call: Callable[[], object]) -> Callable[[], float]:
    """A contender that calls, and drops what comes back."""

    def seconds() -> float:
        start = time.perf_counter()
        call()
        return time.perf_counter() - start

    return seconds


def compare(port: Port, scene: shadows.Scene, params: shadows.Params, maps: shadows.Maps) -> None:
    """Print by how much the float32 stages and the timed picture differ from the package's."""
    frame = shadows.render(scene, params, maps=maps)
    given = exported(scene, params, maps)
    drawn, fast = (port.render(given, params, stages=stages) for stages in (True, False))
    print("\nlargest and mean difference between GLSL in float32 and ibr_ref, nine samples")
    for name in ("warp.rows", "warp.image", "project.coord", "project.shadow", "accumulate.shadow"):
        off = abs(frame.stages[name] - drawn.stages[name])
        print(f"{name:20}{off.max():10.1e}{off.mean():10.1e}")
    for name, color in (("color", drawn.color), ("color, timed", fast.color)):
        off = abs(frame.color - color)
        print(f"{name:20}{off.max():10.1e}{off.mean():10.1e}")


if __name__ == "__main__":
    main()
