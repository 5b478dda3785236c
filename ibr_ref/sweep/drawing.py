"""Pictures of one scene on Dask workers: the frames of a film, and bands of rows. The same bits as from this process."""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from hashlib import sha256
from io import BytesIO
from typing import Any

from ibr_ref.io.extras import needed
from ibr_ref.io.parts import Draw, Drawn, Part, drawn
from ibr_ref.sweep.store import EXTRA
from ibr_ref.sweep.subject import array_with_flags
from ibr_ref.sweep.work import ONE_AT_A_TIME, recent
from ibr_ref.sweep.workers import PER_THREAD, client_of

_scenes: OrderedDict[str, tuple[Any, Callable[..., Any]]] = OrderedDict()


def draw_part(packed: bytes, digest: str, part: Part) -> Drawn:
    """What a worker does. packed: scene and function, whose digest it keeps them under for the next call."""
    with ONE_AT_A_TIME:
        if digest not in _scenes:
            recent(_scenes, digest, 2, needed("cloudpickle", "pictures on workers", EXTRA).loads(packed))
        return drawn(*_scenes[digest], part)


@contextmanager
def on_workers(scheduler: object, scene: Any, render: Callable[..., Any]) -> Iterator[Draw]:
    """A function that draws parts on workers and gives them in their order, a few ahead of who takes them.

    scheduler: a `distributed.Client`, or the address of a scheduler. render(scene, rows=...) gives a frame. Raises as
    `workers.made_by_workers` does; a worker that dies loses nothing but the time.
    """
    packed = _packed((scene, render))
    digest = sha256(packed).hexdigest()
    with client_of(scheduler, None) as client:
        there = client.submit(bytes, packed, key=f"scene-{digest}")
        ahead = PER_THREAD * max(1, sum(client.nthreads().values()))

        def draw(parts: Iterable[Part]) -> Iterator[Drawn]:
            waiting: deque[Any] = deque()
            for part in parts:
                waiting.append(client.submit(draw_part, there, digest, part, pure=False))
                if len(waiting) >= ahead:
                    yield _result(waiting.popleft())
            while waiting:
                yield _result(waiting.popleft())

        yield draw


def _result(future: Any) -> Drawn:
    try:
        result: Drawn = future.result()
    except needed("distributed", "pictures on workers", EXTRA).KilledWorker:
        raise OSError("scheduler: several workers died over a picture (out of memory, perhaps)") from None
    return result


def _packed(value: Any) -> bytes:
    """By cloudpickle, which functions need; arrays come out read-only where they were."""
    cloudpickle = needed("cloudpickle", "pictures on workers", EXTRA)

    class Pickler(cloudpickle.Pickler):  # type: ignore[misc, name-defined]
        def reducer_override(self, value: Any) -> Any:
            found = array_with_flags(value)
            return super().reducer_override(value) if found is NotImplemented else found

    file = BytesIO()
    Pickler(file, protocol=5).dump(value)
    return file.getvalue()
