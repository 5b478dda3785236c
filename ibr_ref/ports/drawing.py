"""The sample ports by name, each with a device of its own: from a case's folder to a drawn one."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ibr_ref.methods import named
from ibr_ref.ports.case_folder import GivenCase, read_case
from ibr_ref.ports.frame import Frame

NOT_PORTED = "the port allows"
"""In what a sample port says of a case that it has no code for; what else it says is wrong with it, or with the driver."""


@dataclass(frozen=True)
class Drawer:
    """A sample port on a device."""

    name: str
    """glsl | wgsl | webgl | plain."""
    words: str
    """The device, as its driver calls it."""
    declares: Mapping[str, str | int]
    """What `port.json` says."""
    draw: Callable[[Path], Frame]
    """The frame of a case's folder, with all stages. Raises ValueError for what is not ported."""

    faults: Mapping[str, str] = field(default_factory=dict)
    """Of the driver, as the port sees them: names in `oracle.probe.DRIVER_FAULTS`, and what shows them."""
    close: Callable[[], None] = lambda: None
    """Gives the device back."""

    def into(self, case: Path, folder: Path) -> None:
        """Draw a case, and write all arrays that it has names for beside `port.json`."""
        try:
            expected = read_case(case).expected
        except (OSError, KeyError, ValueError) as error:
            raise ValueError(f"{case}: is no case that `ibr-ref export` wrote ({error})") from None
        frame = self.draw(case)
        folder.mkdir(parents=True, exist_ok=True)
        for name, array in {"color": frame.color, "depth": frame.depth, **frame.stages}.items():
            if name in expected:
                np.save(folder / f"{name}.npy", np.ascontiguousarray(array))
        (folder / "port.json").write_text(json.dumps(dict(self.declares)) + "\n")


def _of_given(language: str, device: Any) -> Callable[[Path], Frame]:
    """The method's port in a language, on one device; ports are kept."""
    ports: dict[str, Any] = {}

    def draw(folder: Path) -> Frame:
        case = read_case(folder)
        return drawn(case, language, device, ports)

    return draw


def drawn(case: GivenCase, language: str, device: Any, ports: dict[str, Any] | None = None, **options: Any) -> Frame:
    """A frame with all stages; ports: those that are there already; options: those of the method's port."""
    ports = {} if ports is None else ports
    room = named(case.method).sample_ports.get(language)
    if room is None:
        raise ValueError(f"{case.name} is not ported: {case.method} has no port in {language}")
    if case.method not in ports:
        ports[case.method] = room.open()(device)
    try:
        frame: Frame = ports[case.method].render(case.scene, case.params, **options)
    except ValueError as error:
        raise ValueError(f"{case.name} is not ported: {error}") from None
    return frame


def _glsl(adapter: str | None) -> Drawer:
    """adapter: one of Mesa's drivers."""
    if adapter is not None:
        os.environ["MESA_LOADER_DRIVER_OVERRIDE" if adapter == "zink" else "GALLIUM_DRIVER"] = adapter
    if adapter == "softpipe":  # it says 3.3, and has what the ports need of 4.5
        os.environ |= {"MESA_GL_VERSION_OVERRIDE": "4.5", "MESA_GLSL_VERSION_OVERRIDE": "450"}
    try:
        from ibr_ref.ports.glsl import gl

        device = gl.create_device()
    except Exception as error:  # of moderngl, or of the loader that looks for EGL
        raise ValueError(f"no headless OpenGL 4.5 (Debian: libegl1 libgl1-mesa-dri; ibr_ref[gl]): {error}") from None
    if adapter is not None and adapter.lower() not in device.renderer.lower():
        raise ValueError(
            f"adapter: found {adapter!r}, allowed: a driver of OpenGL 4.5 that is there, as {device.renderer}"
        )
    declares = _opengl(int(device.ctx.info["GL_SUBPIXEL_BITS"]))
    return Drawer("glsl", device.renderer, declares, _of_given("glsl", device))


def _opengl(subpixel_bits: int) -> dict[str, str | int]:
    """What a driver of OpenGL is that says so many bits: the profile has 8."""
    coarser = 4 <= subpixel_bits < 8
    return {"profile": "gl", "subpixel_bits": subpixel_bits} if coarser else {"profile": "gl"}


def _wgsl(adapter: str | None) -> Drawer:
    """adapter: words of its summary."""
    try:
        from ibr_ref.ports.wgsl import gpu
    except (ImportError, OSError) as error:
        raise ValueError(f"no WebGPU (pip install 'ibr_ref[webgpu]'): {error}") from None
    device = gpu.create_device(adapter)
    left = gpu.remainder(device, -7, 3)
    faults = {} if left == -1 else {"remainder of unsigned numbers": f"-7 % 3 is {left}, and should be -1"}
    return Drawer("wgsl", device.words, {"profile": "webgpu"}, _of_given("wgsl", device), faults)


def _webgl(adapter: str | None) -> Drawer:
    """adapter: a browser's command."""
    from ibr_ref.ports.webgl.browser import Browser

    browser = Browser(adapter)
    return Drawer("webgl", browser.words, _opengl(browser.subpixel_bits), browser.draw, close=browser.close)


def _plain(adapter: str | None) -> Drawer:
    if adapter is not None:
        raise ValueError(f"adapter: found {adapter!r}, allowed: none with plain, which is NumPy")
    return Drawer("plain", f"NumPy {np.__version__}", {"profile": "ieee32"}, _plainly)


def _plainly(folder: Path) -> Frame:
    """By the port that the oracle is tried with, in float32 arithmetic."""
    from ibr_ref.oracle.arithmetic.device import Policy
    from ibr_ref.oracle.files import load_case

    case = load_case(folder)
    room = named(case.method).plain_port
    if room is None:
        raise ValueError(f"{case.name} is not ported: {case.method} has no plain port")
    try:
        arrays = room.open().Port(case.scene, case.params, Policy(), case.inputs).render()
    except ValueError as error:
        raise ValueError(f"{case.name} is not ported: {error}") from None
    color, depth = (np.asarray(arrays.pop(name)) for name in ("color", "depth"))
    return Frame(color, depth, arrays)


SAMPLES: dict[str, Callable[[str | None], Drawer]] = {
    "glsl": _glsl,
    "wgsl": _wgsl,
    "webgl": _webgl,
    "plain": _plain,
}
"""By name, what opens a device; the argument: which of several. Raise ValueError, one line, where there is none."""
