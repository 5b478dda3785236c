"""One context for all ports: a machine without a headless OpenGL skips what draws."""

from __future__ import annotations

from typing import Any

import pytest


@pytest.fixture(scope="session")
def device() -> Any:
    """OpenGL 4.5 with the reference's clip volume."""
    pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")
    from ibr_ref.ports.glsl import gl

    try:
        return gl.create_device()
    except Exception as error:
        pytest.skip(f"no headless OpenGL 4.5: {error}")
