"""Large frames stay within their memory."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

GIB = 2**30

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="getrusage, which tells the peak, is not on Windows")

PEAK = r"""
import re, resource
try:
    with open("/proc/self/status") as file:
        print(1024 * int(re.search(r"VmHWM:\s+(\d+)", file.read())[1]))
except OSError:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(peak if sys.platform == "darwin" else 1024 * peak)
"""
"""Where the system says it: getrusage begins with what the parent had when it started the process."""

SCRIPT = """
import sys
import ibr_ref
from ibr_ref import displacement, models
camera = ibr_ref.Camera.look_at(eye=(0.6, -0.75, 0.65), target=(0, 0, 0), near=0.1, far=10, width=4096, height=4096)
scene = displacement.Scene(polygons=[models.box()], camera=camera, light=ibr_ref.Light(direction=(0.5, -0.8, 1)))
frame = displacement.render(scene, stages=sys.argv[1] == "stages")
assert frame.color.shape == (4096, 4096, 3)
"""


def printed(*arguments: str) -> str:
    """What a process of its own prints."""
    result = subprocess.run([sys.executable, *arguments], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return result.stdout


@pytest.mark.long
@pytest.mark.parametrize("kept", ["picture", "stages"])
def test_a_frame_of_4096_x_4096_stays_under_4_gib(kept: str) -> None:
    assert int(printed("-c", SCRIPT + PEAK, kept)) < 4 * GIB


LARGE_MAP = """
import sys
from ibr_ref import cli
sys.argv = ["ibr-ref", "render", "displacement", "--height", sys.argv[1], "--out", sys.argv[2], "--size", "1920x1080"]
try:
    cli.main()
except SystemExit as end:
    assert not end.code, end.code
"""


@pytest.mark.long
def test_a_float_height_map_of_8192_x_8192_stays_under_2_gib(tmp_path: Path) -> None:
    rows = np.linspace(0, 1, 8192, dtype=np.float32)
    with (tmp_path / "a.pfm").open("wb") as file:
        file.write(b"Pf\n8192 8192\n-1\n")
        for row in rows:
            file.write((row * rows).tobytes())
    assert int(printed("-c", LARGE_MAP + PEAK, str(tmp_path / "a.pfm"), str(tmp_path / "a.png"))) < 2 * GIB


@pytest.mark.long
def test_50_million_points_stay_under_8_gib() -> None:
    """64 references of 1024 x 768, their own 1.6 GiB included; and a frame takes 4 bytes a point, its pixel's number, and
    no more that grows with them.
    """
    found = json.loads(printed("-m", "tests.splatting.many_points", "64", "picture"))
    assert found["points"] > 50e6
    assert found["peak"] < 8 * GIB
    assert found["peak"] - found["made"] < 4 * found["points"] + GIB // 8


@pytest.mark.long
def test_50_million_points_with_all_stages_stay_under_8_gib() -> None:
    """An eighth of them here, in an eighth of the memory and what does not grow with them. All 64: `python -m
    tests.splatting.many_points 64 stages`, which has its peak at 7.7 GiB.
    """
    found = json.loads(printed("-m", "tests.splatting.many_points", "8", "stages"))
    assert found["peak"] - found["imported"] < 1 * GIB + GIB // 8
