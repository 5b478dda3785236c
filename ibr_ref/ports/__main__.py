"""Draw an exported case in GLSL: `python -m ibr_ref.ports CASE PORT`, two folders.

CASE is what `ibr-ref export` wrote; PORT receives what the port has drawn, for `ibr-ref check CASE PORT`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from ibr_ref.methods import named
from ibr_ref.ports.case_folder import GivenCase, read_case
from ibr_ref.ports.glsl import gl

PROFILE = "gl"
"""What the port claims to be: OpenGL."""


def main() -> None:
    """Read, draw, write."""
    if len(sys.argv) != 3:
        sys.exit("usage: python -m ibr_ref.ports CASE PORT")
    try:
        case = read_case(Path(sys.argv[1]))
    except (OSError, KeyError, ValueError) as error:
        sys.exit(f"{sys.argv[1]}: is no case that `ibr-ref export` wrote ({error})")
    try:
        device = gl.create_device()
    except Exception as error:  # of moderngl, or of the loader that looks for EGL
        sys.exit(f"no headless OpenGL 4.5 (Debian: libegl1 libgl1-mesa-dri): {error}")
    try:
        frame = draw(case, device)
    except ValueError as error:
        sys.exit(f"{case.name} is not ported: {error}")
    write(frame, case, Path(sys.argv[2]))


def draw(case: GivenCase, device: gl.Device | None = None, **options: Any) -> gl.Frame:
    """A frame with all stages; the options are those of the method's port. Raises ValueError for what is not ported."""
    port = named(case.method).sample_port
    if port is None:
        raise ValueError(f"{case.method} has no port")
    frame: gl.Frame = port.open()(device).render(case.scene, case.params, **options)
    return frame


def write(frame: gl.Frame, case: GivenCase, folder: Path) -> None:
    """NAME.npy of all arrays that the case has names for, the picture as bytes too, and what the port claims to be."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, array in {"color": frame.color, "depth": frame.depth, **frame.stages}.items():
        if name in case.expected:
            np.save(folder / f"{name}.npy", np.ascontiguousarray(array))
    (folder / "port.json").write_text(json.dumps({"profile": PROFILE}) + "\n")


if __name__ == "__main__":
    main()
