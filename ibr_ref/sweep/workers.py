"""Where the rows are made: in this process, on a Dask cluster of this machine, or on one that is there already."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from typing import Any, NamedTuple
from urllib.parse import urlsplit

from ibr_ref.io.extras import needed
from ibr_ref.scene import checks
from ibr_ref.scene.digests import sources_digest
from ibr_ref.sweep.settings import Setting, words
from ibr_ref.sweep.store import EXTRA
from ibr_ref.sweep.subject import Subject
from ibr_ref.sweep.work import Row, rows_of

MOST_WORKERS = 1024

PATIENCE = 10.0
"""Seconds in which a scheduler answers."""

PER_THREAD = 4
"""Tasks a thread of the workers at a time: enough that none waits, few enough that a worker that dies loses little."""


class Task(NamedTuple):
    """What is handed out: some views of one setting."""

    setting: Setting
    params: Any
    views: tuple[int, ...]


Done = tuple[Task, list[Row]]


def made_here(subject: Subject, tasks: Sequence[Task]) -> Iterator[Done]:
    """One after another, in this process."""
    packed, digest = subject.packed(), subject.digest
    for task in tasks:
        with _naming(task.setting):
            rows = rows_of(packed, digest, task.params, task.views)
        yield task, rows


def made_by_workers(subject: Subject, tasks: Sequence[Task], scheduler: object, count: int | None) -> Iterator[Done]:
    """In whatever order workers end them; what a worker that dies was at goes to another. Needs dask and distributed.

    scheduler: a `distributed.Client`, the address of a scheduler, or None for `count` processes here (None: as many as
    there are processors). Raises OSError for one that does not answer, for workers with other sources of this package, and
    for a task that several workers died over.
    """
    with client_of(scheduler, count) as client:
        yield from _handed_out(client, subject, tasks)


def _handed_out(client: Any, subject: Subject, tasks: Sequence[Task]) -> Iterator[Done]:
    """The first task of each machine by itself, which compiles for the others there; then all the rest."""
    threads, waiting = client.nthreads(), iter(tasks)
    # The subject is a task's result: lost with the workers that have it, it is made anew.
    packed = client.submit(_received, subject.packed(), key=f"subject-{subject.digest}")

    def submit(task: Task, **where: Any) -> Any:
        return client.submit(rows_of, packed, subject.digest, task.params, task.views, pure=False, **where)

    machines = {urlsplit(address).hostname: address for address in threads}
    first = zip(machines.values(), waiting, strict=False)
    yield from _ended({submit(t, workers=[a], allow_other_workers=True): t for a, t in first}, iter(()), submit)
    room = PER_THREAD * max(1, sum(threads.values()))
    yield from _ended({submit(task): task for task in islice(waiting, room)}, waiting, submit)


def _ended(out: dict[Any, Task], waiting: Iterator[Task], submit: Any) -> Iterator[Done]:
    """Each task as it ends, the next one handed out in its place."""
    distributed = needed("distributed", "sweeps on workers", EXTRA)
    ended = distributed.as_completed(list(out))
    for future in ended:
        task = out.pop(future)
        following = next(waiting, None)
        if following is not None:
            again = submit(following)
            out[again] = following
            ended.add(again)
        try:
            with _naming(task.setting):
                rows = future.result()
        except distributed.KilledWorker:
            why = "out of memory, perhaps; distributed.scheduler.allowed-failures says how many may"
            raise OSError(f"{words(task.setting)}: several workers died over it ({why})") from None
        yield task, rows


def _received(packed: bytes) -> bytes:
    return packed


@contextmanager
def _naming(setting: Setting) -> Iterator[None]:
    """Errors start with the setting."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{words(setting)}: {error}") from None


# --- Clusters --------------------------------------------------------------------------------------------------------


@contextmanager
def client_of(scheduler: object, count: int | None) -> Iterator[Any]:
    """A client whose workers have these sources, closed afterwards, and its cluster too if that was made here."""
    with _connected(scheduler, count) as client:
        _check_sources(client)
        yield client


@contextmanager
def _connected(scheduler: object, count: int | None) -> Iterator[Any]:
    distributed = needed("distributed", "sweeps on workers", EXTRA)
    if isinstance(scheduler, distributed.Client):
        yield scheduler
    elif scheduler is not None:
        try:
            client = distributed.Client(scheduler, timeout=PATIENCE)
        except (OSError, ValueError) as error:
            raise checks.reject("scheduler", scheduler, f"the address of a Dask scheduler ({error})") from None
        with client:
            client.wait_for_workers(1)
            yield client
    else:
        with local_cluster(distributed, count) as cluster, distributed.Client(cluster) as client:
            yield client


def local_cluster(distributed: Any, count: int | None) -> Any:
    """A process for every processor, or so many; each has its share of them for its kernels."""
    processors = os.cpu_count() or 1
    workers = (
        min(processors, MOST_WORKERS) if count is None else checks.whole("workers", count, low=1, high=MOST_WORKERS)
    )
    return distributed.LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=True,
        dashboard_address=":0",
        silence_logs=logging.CRITICAL,
        env={"NUMBA_NUM_THREADS": str(max(1, processors // workers)), **_THREADS},
    )


_THREADS = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
"""Of other libraries, which Dask sets likewise."""


def our_sources() -> str:
    """Digest of the package's sources here."""
    return sources_digest()


def _check_sources(client: Any) -> None:
    ours = our_sources()
    for address, theirs in client.run(sources_digest).items():
        if theirs != ours:
            raise OSError(
                f"scheduler: found a worker at {address} with other sources of ibr_ref, allowed: those of here"
            )
