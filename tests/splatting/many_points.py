"""Peak memory of a frame of many points, for a process of its own: `python -m tests.splatting.many_points 64 stages`.

So many distinct references of 1024 x 768 pixels, all of them points; 64 have 50,331,648. Prints JSON: the points, and bytes
once everything is imported, with the references made, and at the peak.
"""

from __future__ import annotations

import json
import re
import resource
import sys

import numpy as np

from ibr_ref import Camera, DepthImage, splatting

WIDTH, HEIGHT = 1024, 768


def peak() -> int:
    """Bytes, so far. Where the system says it: getrusage begins with what the parent had when it started the process."""
    try:
        with open("/proc/self/status") as file:
            found = re.search(r"VmHWM:\s+(\d+)", file.read())
        assert found is not None
        return 1024 * int(found[1])
    except OSError:
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return most if sys.platform == "darwin" else 1024 * most


def camera(y: float, x: float = 5.0) -> Camera:
    return Camera.look_at(eye=(x, y, 0.5), target=(0, 0, 0), near=0.1, far=20.0, width=WIDTH, height=HEIGHT)


def main(count: int, stages: bool) -> None:
    imported = peak()
    images = [
        DepthImage(
            color=np.full((HEIGHT, WIDTH, 3), k / count), depth=np.full((HEIGHT, WIDTH), 4.0), camera=camera(k / count)
        )
        for k in range(count)
    ]
    made = peak()
    scene = splatting.Scene(images=images, camera=camera(0.5, 5.5), light=None)
    frame = splatting.render(scene, splatting.Params(alpha=2.0), stages=stages)
    assert (frame.depth < 1.0).mean() > 0.5
    assert len(frame.stages) == (13 if stages else 0)
    print(json.dumps({"points": count * WIDTH * HEIGHT, "imported": imported, "made": made, "peak": peak()}))


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2:] == ["stages"])
