"""The pictures of one method, drawn in a process of its own: the kernels of all methods are compiled side by side."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ibr_ref.methods import Method

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

    from ibr_ref.demo.picture import Picture


@dataclass(frozen=True)
class Compiling:
    """A kernel is being compiled."""

    name: str


@dataclass(frozen=True)
class Drawn:
    """A picture is in the folder."""

    caption: str
    settings: str
    paper_ms: str
    color: Any
    """(480, 640, 3)."""


@dataclass(frozen=True)
class Finished:
    """All are; what follows are their times, once they are asked for: milliseconds, None where there is no frame."""


def draw(method: Method, folder: Path, said: Connection) -> None:
    """Draw a method's pictures into a folder, and say so; then wait to be asked, and say how long their frames take.

    What it is asked by is any object: frames are timed when no other process draws. An error is said in place of what it
    kept from happening.
    """
    from ibr_ref import jit, methods

    if method.name not in methods.names():
        methods.register(method)  # as it is where the process was started
    try:
        with jit.compilations(lambda name: said.send(Compiling(name))):
            pictures = _drawn(method, folder, said.send)
        said.send(Finished())
        said.recv()
        said.send([_milliseconds(picture) for picture in pictures])
    except (ValueError, OSError, MemoryError) as error:
        said.send(error)


def _drawn(method: Method, folder: Path, say: Callable[[object], None]) -> list[Picture]:
    from ibr_ref.io import write_image

    assert method.demo is not None
    pictures: list[Picture] = method.demo.open().pictures()
    for picture in pictures:
        color = picture.draw()
        write_image(folder / f"{picture.name}.png", color)
        say(Drawn(picture.caption, picture.settings, picture.paper_ms, color))
    return pictures


def _milliseconds(picture: Picture) -> float | None:
    """Of a second, warm rendering of its frame."""
    if picture.frame is None:
        return None
    picture.frame()
    start = time.perf_counter()
    picture.frame()
    return 1e3 * (time.perf_counter() - start)
