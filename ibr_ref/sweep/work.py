"""What a worker does: the rows of one setting. The same bits on any worker, but for the milliseconds."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable, Sequence
from threading import Lock
from typing import Any

from ibr_ref.sweep.measures import MILLISECONDS
from ibr_ref.sweep.rooms import Room, room_of
from ibr_ref.sweep.subject import Subject

CHUNK = 8
"""Views of a task, and as many whose truths a process keeps."""

Row = dict[str, float | None]
"""Values of the measures; None where there is nothing to measure."""

ONE_AT_A_TIME = Lock()
"""Kernels share their threads: a process calls them from one of its own."""

_subjects: OrderedDict[str, Subject] = OrderedDict()
_kept: OrderedDict[tuple[str, int], dict[Any, Any]] = OrderedDict()


def rows_of(packed: bytes, digest: str, params: Any, views: Sequence[int]) -> list[Row]:
    """Render and measure some of a subject's views with these parameters. packed: `Subject.packed`, digest: its digest.

    The subject, and what its views are measured against, stay in the process for the next call.
    """
    with ONE_AT_A_TIME:
        if digest not in _subjects:
            recent(_subjects, digest, 2, Subject.unpacked(packed))
        subject = _subjects[digest]
        room = room_of(subject.method)
        return [_row(room, subject.views[view], params, recent(_kept, (digest, view), CHUNK, {})) for view in views]


def _row(room: Room, view: Any, params: Any, kept: dict[Any, Any]) -> Row:
    row: Row = room.measured(view, params, kept)
    draw = room.drawing(view, params)
    row[MILLISECONDS] = 1000.0 * min(_seconds(draw), _seconds(draw))  # the first one may have to load kernels
    return row


def _seconds(draw: Callable[[], object]) -> float:
    start = time.perf_counter()
    draw()
    return time.perf_counter() - start


def recent(store: OrderedDict[Any, Any], key: Any, most: int, new: Any) -> Any:
    """What is kept under a key, or the new value; the one that was asked for longest ago makes room."""
    store.setdefault(key, new)
    store.move_to_end(key)
    if len(store) > most:
        store.popitem(last=False)
    return store[key]
