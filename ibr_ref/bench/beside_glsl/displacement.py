"""Whole frames of protruded displacement mapping: the GLSL port on this machine's OpenGL beside the package.

Run `python -m ibr_ref.bench.beside_glsl.displacement`. The contenders take turns, so that all of them
see the same state of the machine, in blocks of consecutive frames, as an application draws them: the first frames of a
block, which wake the contender's threads and fill the caches after the other, do not count. A GL frame is submission and
glFinish, without read-back, into an RGBA8 and a 32-bit float depth attachment; a frame of the package is a call of `render`
with everything that it returns.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import ibr_ref
from ibr_ref import displacement, models
from ibr_ref.bench import gathers
from ibr_ref.ports.glsl.displacement import Port

BLOCKS = 4
WARM_UP, FRAMES = 2, 5
"""Frames of a block that do not count, and then those that do."""

LINEAR_STEPS = (10, 50)
WANTED = {10: 0.6, 50: 0.4}
"""Best frame of the package, as a share of GLSL's, by N."""
BINARY_STEPS = 6
VISIBLE = 2 / 255
"""Two colours that differ by more than this in some channel count as different."""


def main() -> None:
    """Measure and print the table."""
    port = Port()
    scene = box_scene()
    print(f"GL_RENDERER: {port.device.renderer}; {os.cpu_count()} CPUs")
    print(
        f"{scene.camera.width} x {scene.camera.height}, box(), M = {BINARY_STEPS}, milliseconds of "
        f"{BLOCKS * FRAMES} frames each, in {BLOCKS} blocks in turn\n"
    )
    print(f"{'':28}{'N':>4}{'best':>9}{'median':>9}")
    notes = [line for steps in LINEAR_STEPS for line in measure(port, scene, steps)]
    print("\n" + "\n".join(notes))


def box_scene() -> displacement.Scene:
    """The built-in box, seen obliquely so that it fills most of a 640 × 480 image."""
    camera = ibr_ref.Camera.look_at(
        eye=(0.6, -0.75, 0.65),
        target=(0.0, 0.0, 0.0),
        up=(0.0, 0.0, 1.0),
        vertical_fov=45.0,
        near=0.1,
        far=10.0,
        width=640,
        height=480,
    )
    light = ibr_ref.Light(position=(1.5, -0.5, 2.0), ambient=0.2, diffuse=0.8)
    return displacement.Scene(polygons=[models.box()], camera=camera, light=light, background=(0.0, 0.0, 0.0))


def measure(port: Port, scene: displacement.Scene, steps: int) -> list[str]:
    """Print the rows for one number of linear steps; the answer is what to print below the table."""
    params = displacement.Params(linear_steps=steps, binary_steps=BINARY_STEPS)
    plain = port.prepare(scene, params, stages=False)
    packed = port.prepare(scene, params, stages=False, packed=True)
    staged = port.prepare(scene, params, stages=True)
    # Pairs of like work: a frame that keeps 65 MB of stages returns them to the system, and whoever comes next pays.
    pictures: dict[str, Callable[[], float]] = {
        "(a) GLSL": plain.seconds,
        "(b) ibr_ref, stages=False": lambda: render_seconds(scene, params, stages=False),
        "    GLSL, packed heights": packed.seconds,
    }
    with_stages: dict[str, Callable[[], float]] = {
        "    GLSL, stage attachments": staged.seconds,
        "(c) ibr_ref, stages=True": lambda: render_seconds(scene, params, stages=True),
    }
    times = alternate(pictures) | alternate(with_stages)
    for name, seconds in times.items():
        print(f"{name:28}{steps:4}{1e3 * min(seconds):9.2f}{1e3 * float(np.median(seconds)):9.2f}")
    best = {name: min(seconds) for name, seconds in times.items()}
    ours = best["(b) ibr_ref, stages=False"]
    ratio = f"(b) takes {ours / best['(a) GLSL']:.2f} of (a), wanted: {WANTED[steps]:g} at most"
    limit = gathers.line(gathers.beside(scene, params, ours))
    note = agreement(plain.read(), displacement.render(scene, params, stages=False))
    for prepared in (plain, packed, staged):
        prepared.release()
    return [f"N = {steps}: {line}" for line in (ratio, limit, note)]


def alternate(contenders: dict[str, Callable[[], float]]) -> dict[str, list[float]]:
    """Seconds of `BLOCKS` times `FRAMES` frames each; a block that does not count comes first (compilation)."""
    times: dict[str, list[float]] = {name: [] for name in contenders}
    for block in range(1 + BLOCKS):
        for name, contender in contenders.items():
            seconds = [contender() for _ in range(WARM_UP + FRAMES)]
            times[name] += seconds[WARM_UP:] if block > 0 else []
    return times


def render_seconds(scene: displacement.Scene, params: displacement.Params, *, stages: bool) -> float:
    """Time of one frame of the package."""
    start = time.perf_counter()
    displacement.render(scene, params, stages=stages)
    return time.perf_counter() - start


def agreement(ours: Any, theirs: Any) -> str:
    """The share of pixels whose colour differs visibly, of all and of those that show something."""
    differs = (np.abs(ours.color - theirs.color) > VISIBLE).any(axis=2)
    shown = (ours.depth < 1) | (theirs.depth < 1)
    return (
        f"colour of (a) and (b) differs by more than 2/255 in {100 * differs.mean():.4f} % of the pixels "
        f"({differs.sum()} of {differs.size}; {100 * shown.mean():.1f} % show something)"
    )


if __name__ == "__main__":
    main()
