"""A sweep, from its settings to its result."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from os import PathLike
from typing import Any

from ibr_ref.io.outputs import check_writable
from ibr_ref.scene import checks
from ibr_ref.sweep.measures import Measure
from ibr_ref.sweep.result import Sweep
from ibr_ref.sweep.rooms import Room, room_of
from ibr_ref.sweep.settings import settings_of
from ibr_ref.sweep.store import Store, about
from ibr_ref.sweep.subject import Subject
from ibr_ref.sweep.views import count_of
from ibr_ref.sweep.work import CHUNK
from ibr_ref.sweep.workers import Task, made_by_workers, made_here

Progress = Callable[[str, int, int], None]
"""Called with words, rows done, and rows in all."""

_BETWEEN_WRITES = 5.0
"""Seconds: what an interrupted sweep may lose."""


def measures(method: str) -> dict[str, Measure]:
    """What is measured, by the name of the column. Raises ValueError for what is no method."""
    return dict(room_of(method).MEASURES)


def sweep(
    method: str,
    scene: Any,
    *,
    over: Mapping[str, Sequence[Any]],
    params: Any = None,
    views: int = 1,
    against: Any = None,
    out: str | PathLike[str] | None = None,
    scheduler: Any = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Sweep:
    """Render a scene with every combination of parameters from every view, and measure each picture.

    method: "displacement", "splatting" or "shadows", and scene: its Scene. over: values by fields of its Params (shadows:
    and "controls"; the names of `ibr-ref render`'s options will do); params: the others, the defaults without.
    views: so many cameras on a circle around the scene, the first its own; for shadows as many places of the caster.
    against: displacement "exact"; shadows "direct"; splatting a `Mesh`, or pictures (`DepthImage`) in place of views from
    around, or None, which leaves out the decibels.
    out: a Parquet file: rows that it has are not made again, new ones are added every few seconds.
    scheduler: a `distributed.Client`, or the address of a scheduler; None: a cluster of this machine, with `workers`
    processes (None: one a processor; 0: this process, without Dask). From a script that is run the call stands below
    `if __name__ == "__main__":`, as each process imports it.
    progress(words, done, total) is called as rows come in.
    Raises ValueError for what is not allowed, with the setting where it is one's, and for a file of another sweep; OSError
    for a cluster that does not answer or whose workers die.
    """
    room = room_of(method)
    params = room.Swept() if params is None else _swept(room, params)
    over = {room.ALIASES.get(name, name): values for name, values in over.items()}
    count = count_of(views)
    wanted = settings_of(params, over, count)
    subject = Subject(method, *room.viewed(scene, count, against))
    rest = {f.name: getattr(params, f.name) for f in fields(params) if f.name not in over}
    store = Store(out, about(subject.digest, rest), tuple(over), tuple(room.MEASURES))
    if out is not None:
        check_writable(out)
    store.load()
    tasks = _tasks(store, wanted, count)
    here = workers == 0 and scheduler is None
    done = made_here(subject, tasks) if here else made_by_workers(subject, tasks, scheduler, workers)
    if tasks:
        _collect(
            store, done, len(wanted) * count - sum(len(task.views) for task in tasks), len(wanted) * count, progress
        )
    settings = [setting for setting, _ in wanted]
    return Sweep(method, settings, room.MEASURES, store.table(settings, count), room.ERROR, room.COST)


def _swept(room: Room, params: Any) -> Any:
    """The parameters with the fields of a sweep's own."""
    if not isinstance(params, room.Params):
        raise checks.reject("params", type(params).__name__, "the method's Params")
    return room.Swept(**{field.name: getattr(params, field.name) for field in fields(params)})


def _tasks(store: Store, wanted: Sequence[tuple[dict[str, Any], Any]], views: int) -> list[Task]:
    """What is missing: for a few views at a time all settings, so that what the views are measured against is kept."""
    tasks = []
    for first in range(0, views, CHUNK):
        for setting, params in wanted:
            chunk = range(first, min(first + CHUNK, views))
            missing = tuple(view for view in chunk if store.key(setting, view) not in store.rows)
            if missing:
                tasks.append(Task(setting, params, missing))
    return tasks


def _collect(store: Store, done: Any, known: int, total: int, progress: Progress | None) -> None:
    """Take rows as they come in; whatever happens, those that came are written."""
    written = time.monotonic()
    try:
        for task, rows in done:
            for view, row in zip(task.views, rows, strict=True):
                store.add(task.setting, view, row)
            known += len(rows)
            if progress is not None:
                progress("rows", known, total)
            if time.monotonic() - written > _BETWEEN_WRITES:
                store.write()
                written = time.monotonic()
    finally:
        store.write()
