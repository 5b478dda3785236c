"""Frames a second that `ibr-ref view` shows while the box is turned, in headless Chromium: `python -m tests.viewer.rate`.

Everything takes its share: the page's events, the render, the bytes over loopback, the canvas, and what else the machine
does. The processor's seconds of the server alone, by frame, stand beside.
"""

from __future__ import annotations

import argparse
import math
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

from ibr_ref import Camera, Light, models
from ibr_ref.displacement import Params, Scene
from ibr_ref.viewer import Server, Session, Subject
from tests import browser
from tests.browser import Page

RESTED = "document.body.dataset.rested === 'yes'"


def box(width: int, height: int) -> Subject:
    """The README's scene: 50 linear steps."""
    camera = Camera.look_at(
        eye=(0.75, -0.95, 0.75), target=(0, 0, 0), vertical_fov=45, near=0.1, far=10, width=width, height=height
    )
    scene = Scene(polygons=[models.box()], camera=camera, light=Light(direction=(0.5, -0.8, 1)))
    return Subject(scene, Params(linear_steps=50, binary_steps=6, steep_threshold=0.1))


def turned(page: Page, seconds: float) -> tuple[int, float, float]:
    """Frames, and the seconds and the server's processor seconds that they took, with the left button held."""
    left, top, width, height = page.box("#view")
    held: dict[str, Any] = {"button": "left", "buttons": 1}
    middle = left + 0.3 * width, top + 0.5 * height
    page.mouse("mousePressed", *middle, clickCount=1, **held)
    before, started, used = _frames(page), time.perf_counter(), time.process_time()
    while (passed := time.perf_counter() - started) < seconds:
        across = 0.15 * width * math.sin(2.0 * passed)
        page.mouse("mouseMoved", middle[0] + across, middle[1] + 0.3 * across, **held)
    shown, used = _frames(page) - before, time.process_time() - used
    page.mouse("mouseReleased", *middle, clickCount=1, **held)
    return shown, passed, used


def _frames(page: Page) -> int:
    return int(page.value("document.body.dataset.frames"))


def main() -> None:
    """Measure, and print a line for each size."""
    parser = argparse.ArgumentParser(prog="python -m tests.viewer.rate")
    parser.add_argument("--seconds", type=float, default=10.0)
    seconds = parser.parse_args().seconds
    for width, height in ((640, 480), (1000, 1000)):
        session = Session(box(width, height))
        session.warm()
        with Server(session) as server, tempfile.TemporaryDirectory() as folder, browser.browser(Path(folder)) as page:
            thread = threading.Thread(target=server.serve_forever)
            thread.start()
            page.open(server.address)
            page.wait(RESTED)
            shown, passed, used = turned(page, seconds)
            server.shutdown()
            thread.join()
        print(
            f"{width} x {height}: {shown / passed:.1f} frames a second, {1e3 * used / shown:.1f} ms of the processor each"
        )


if __name__ == "__main__":
    main()
