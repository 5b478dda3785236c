"""Sweeps on two worker processes: the same rows, also where one of them dies."""

from __future__ import annotations

import os
import signal
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from ibr_ref.displacement import Scene
from ibr_ref.scene import Camera
from ibr_ref.sweep import sweep, workers
from ibr_ref.sweep.store import Store
from tests.sweep.scenes import bumps
from tests.sweep.test_sweep import rows

distributed = pytest.importorskip("distributed")

OVER = {"linear_steps": list(range(2, 22)), "binary_steps": [0, 6]}


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    with workers.local_cluster(distributed, 2) as cluster, distributed.Client(cluster) as client:
        yield client


def test_rows_are_those_of_one_process_though_a_worker_is_killed(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """In the middle, with the tasks that it has: no row is lost, none comes twice."""
    added: Counter[Any] = Counter()
    add = Store.add
    monkeypatch.setattr(Store, "add", lambda self, *row: (added.update([self.key(*row[:2])]), add(self, *row)))
    pids = client.run(os.getpid)
    assert len(set(pids.values())) == 2

    def kill(_: str, done: int, total: int) -> None:
        if done >= total // 3 and pids:
            os.kill(pids.popitem()[1], signal.SIGKILL)
            pids.clear()

    found = sweep("displacement", bumps(), over=OVER, views=2, scheduler=client, progress=kill)
    assert not pids, "one was killed"
    assert len(added) == 80
    assert set(added.values()) == {1}
    assert rows(found) == rows(sweep("displacement", bumps(), over=OVER, views=2, workers=0))


def test_errors_come_back(client: Any) -> None:
    with pytest.raises(ValueError, match=r"^faces=extended: faces: found 'extended', allowed: an eye above"):
        sweep("displacement", low(), over={"faces": ["auxiliary", "extended"]}, scheduler=client)


def test_workers_with_other_sources_are_refused(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "our_sources", lambda: "0")
    with pytest.raises(OSError, match=r"^scheduler: found a worker at tcp://.* with other sources of ibr_ref"):
        sweep("displacement", bumps(), over={"linear_steps": [2]}, scheduler=client)


def test_a_scheduler_that_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "PATIENCE", 0.3)
    for address in ("tcp://127.0.0.1:9", "nonsense://"):
        with pytest.raises(ValueError, match=r"^scheduler: found '.*', allowed: the address of a Dask scheduler"):
            sweep("displacement", bumps(), over={"linear_steps": [2]}, scheduler=address)


def low() -> Scene:
    """Seen from below the top of the volume."""
    camera = Camera.look_at(eye=(0.9, -1.2, 0.1), target=(0, 0, 0.1), near=0.1, far=9, width=24, height=18)
    return replace(bumps(), camera=camera)
