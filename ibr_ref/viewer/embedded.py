"""The page in a notebook: served by a process of its own, so that the notebook's stays free and kernels have one thread."""

from __future__ import annotations

import pickle
import subprocess
import sys
from typing import Any

from ibr_ref.oracle.cases.case import method_of
from ibr_ref.scene import checks
from ibr_ref.viewer.session import Subject, check

LOWEST, HIGHEST = 200, 4000
"""Pixels of the frame in a notebook."""


class View:
    """A page that is being served. Notebooks show it; `close`, or the end of this process, ends it."""

    def __init__(self, subject: Subject, height: int) -> None:
        self.height = height
        # What is piped to it says that this process is still there.
        self._process = subprocess.Popen(
            [sys.executable, "-m", "ibr_ref.viewer"], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            pickle.dump(subject, self._process.stdin)
            self._process.stdin.flush()
            answer = self._process.stdout.readline().decode().strip()
        except OSError:
            answer = ""
        if not answer.startswith("http://"):
            self.close()
            raise OSError(answer or "the page's process has ended before it had an address")
        self.address = answer
        """Where the page is; whoever has it may look."""

    def __repr__(self) -> str:
        return f"View({self.address})"

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self.height}px; border: 0"
        return f'<iframe src="{self.address}" style="{style}" allow="clipboard-write"></iframe>'

    def close(self) -> None:
        """End the page."""
        self._process.kill()
        self._process.communicate()


def view(scene: Any, params: Any = None, *, inputs: dict[str, Any] | None = None, height: int = 760) -> View:
    """A page about a scene of any method, to be shown by the notebook whose cell ends with it.

    params: where its sliders stand at first; None: the method's defaults. inputs: what else `render` is given, such as
    {"maps": maps} of shadows. height: of the frame, pixels. What is turned on the page changes nothing here. Raises
    ValueError for what is no scene of a method with pages, and OSError where no page can be served.
    """
    from ibr_ref import methods

    height = checks.whole("height", height, low=LOWEST, high=HIGHEST)
    params = methods.named(method_of(scene)).package.open().Params() if params is None else params
    subject = Subject(scene=scene, params=params, inputs=inputs or {})
    check(subject)
    return View(subject, height)
