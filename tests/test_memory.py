"""A large frame stays within its memory."""

from __future__ import annotations

import subprocess
import sys

import pytest

SCRIPT = """
import resource, sys
import ibr_ref
from ibr_ref import displacement, models
camera = ibr_ref.Camera.look_at(eye=(0.6, -0.75, 0.65), target=(0, 0, 0), near=0.1, far=10, width=4096, height=4096)
scene = displacement.Scene(polygons=[models.box()], camera=camera, light=ibr_ref.Light(direction=(0.5, -0.8, 1)))
frame = displacement.render(scene, stages=sys.argv[1] == "stages")
assert frame.color.shape == (4096, 4096, 3)
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(peak if sys.platform == "darwin" else 1024 * peak)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="getrusage, which tells the peak, is not on Windows")
@pytest.mark.parametrize("kept", ["picture", "stages"])
def test_a_frame_of_4096_x_4096_stays_under_4_gib(kept: str) -> None:
    result = subprocess.run([sys.executable, "-c", SCRIPT, kept], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert int(result.stdout) < 4 * 2**30
