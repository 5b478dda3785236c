"""Whole frames of splatting 786,432 points: the GLSL port on this machine's OpenGL beside the package.

Run `python -m ibr_ref.bench.beside_glsl.splatting [BLOCKS]`. Breakdancers, camera 0 seen from camera 1,
where `../shared/data` has it, else a depth image by formula; widths by `fit_splat_law`. The contenders take turns in blocks
of consecutive frames, the first of which do not count: each is measured with its own caches warm, all under the same states
of the machine. A GL frame is submission and glFinish, without read-back, into an RGBA8 and a 32-bit float depth attachment,
the textures uploaded before. A frame of the package is a call of `render` with everything that it returns.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import ibr_ref
from ibr_ref import io, splatting
from ibr_ref.ports.described import described
from ibr_ref.ports.glsl.splatting import Port

DATA = Path(__file__).resolve().parents[4] / "shared" / "data" / "breakdancers"
BLOCKS = 6
WARM_UP = 2
COUNTED = 5
"""Frames of a block: those that do not count, then those that do."""
WANTED_LIT = 0.2
"""Best lit frame of the package at most, as a share of that of GLSL's point sprites."""
VISIBLE = 2 / 255
"""Two colours that differ by more than this in some channel count as different."""


def main() -> None:
    """Measure and print the tables."""
    blocks = int(sys.argv[1]) if len(sys.argv) > 1 else BLOCKS
    port = Port()
    name, image, camera = pictures()
    law = splatting.fit_splat_law([image], camera)
    params = splatting.Params(alpha=law.alpha, beta=law.beta, gamma=law.gamma, delta=law.delta)
    print(f"GL_RENDERER: {port.device.renderer}; {os.cpu_count()} CPUs")
    print(f"{name}: {np.asarray(image.mask).sum():,} points into {camera.width} x {camera.height}")
    print(f"fitted W = {law.alpha:g} / ({law.beta:.3g} d^2 + {law.gamma:.3g} d + {law.delta:.3g})")
    print(f"{blocks} blocks of {COUNTED} frames each after {WARM_UP} that do not count")
    light = ibr_ref.Light(position=camera.eye[:3], ambient=0.2, diffuse=0.7, specular=0.2, exponent=16)
    for title, lamp in (("lit in the vertex stage", light), ("baked-in colours", None)):
        scene = splatting.Scene(images=[image], camera=camera, light=lamp, background=(0.0, 0.0, 0.0))
        print(f"\n{title:36}{'best ms':>9}{'median ms':>11}{'best Mpoints/s':>16}{'beside (a): best':>18}{'median':>8}")
        share = measure(port, scene, params, blocks)
        wanted = f", wanted: {WANTED_LIT:g} at most" if lamp is not None else ""
        print(f"(c) takes {share:.2f} of (a){wanted}")


def pictures() -> tuple[str, ibr_ref.DepthImage, ibr_ref.Camera]:
    """A name, the reference image and the camera that sees it."""
    if DATA.is_dir():
        first, second = io.read_msr(DATA, frame=0, cameras=(0, 1))
        return "Breakdancers, camera 0 seen from camera 1", first, second.camera
    width, height = 1024, 768
    rows, columns = np.indices((height, width))
    depth = 4.0 + 0.5 * np.sin(columns / 60.0) * np.cos(rows / 45.0) + ((columns // 128 + rows // 128) % 2)
    color = np.stack([columns % 256, rows % 256, (columns + rows) // 8 % 256], axis=2) / 255.0
    cameras = [
        ibr_ref.Camera.look_at(
            eye=(x, -4.5, 0.0), target=(x, 0.0, 0.0), vertical_fov=40.0, near=1.0, far=20.0, width=width, height=height
        )
        for x in (0.0, 0.3)
    ]
    return "waves and steps by formula", ibr_ref.DepthImage(color=color, depth=depth, camera=cameras[0]), cameras[1]


def measure(port: Port, scene: splatting.Scene, params: splatting.Params, blocks: int) -> float:
    """Print the rows of one lighting, and by how much the pictures differ; the package's best time as a share of GLSL's."""
    given = described("splatting", scene, params).scene
    plain = port.prepare(given, params, stages=False, primitive="points")
    quads = port.prepare(given, params, stages=False, primitive="quads")
    staged = port.prepare(given, params, stages=True, primitive="points")
    contenders: dict[str, Callable[[], float]] = {
        "(a) GLSL, point sprites": plain.seconds,
        "(b) GLSL, quads": quads.seconds,
        "(c) ibr_ref, stages=False": lambda: render_seconds(scene, params, stages=False),
    }
    # Apart: who keeps 100 MB of stages returns them to the system, and whoever comes next pays.
    with_stages: dict[str, Callable[[], float]] = {
        "(d) GLSL sprites, stage attachments": staged.seconds,
        "(e) ibr_ref, stages=True": lambda: render_seconds(scene, params, stages=True),
    }
    points = sum(int(np.asarray(image.mask).sum()) for image in scene.images)
    seconds = in_blocks(contenders, blocks) | in_blocks(with_stages, blocks)
    base = seconds["(a) GLSL, point sprites"]
    for name, times in seconds.items():
        best, median = min(times), float(np.median(times))
        speed = f"{1e3 * best:9.2f}{1e3 * median:11.2f}{1e-6 * points / best:16.2f}"
        print(f"{name:36}{speed}{min(base) / best:17.2f}x{float(np.median(base)) / median:7.2f}x")
    frame = splatting.render(scene, params, stages=False)
    for name, prepared in (("(a)", plain), ("(b)", quads)):
        prepared.draw()
        differs = (np.abs(prepared.read().color - frame.color) > VISIBLE).any(axis=2)
        print(f"colour of {name} and (c) differs by more than 2/255 in {100 * differs.mean():.4f} % of the pixels")
    for prepared in (plain, quads, staged):
        prepared.release()
    return min(seconds["(c) ibr_ref, stages=False"]) / min(base)


def in_blocks(contenders: dict[str, Callable[[], float]], blocks: int) -> dict[str, list[float]]:
    """Seconds of the frames that count."""
    seconds: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(blocks):
        for name, contender in contenders.items():
            frames = [contender() for _ in range(WARM_UP + COUNTED)]
            seconds[name] += frames[WARM_UP:]
    return seconds


def render_seconds(scene: splatting.Scene, params: splatting.Params, *, stages: bool) -> float:
    """Time of one frame of the package."""
    start = time.perf_counter()
    splatting.render(scene, params, stages=stages)
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
