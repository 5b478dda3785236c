"""Parts of a case side by side: what they give depends neither on the threads nor on where the parts end."""

from __future__ import annotations

import pickle
import threading
from functools import partial

import numba
import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.bounds import Bounds
from ibr_ref.oracle.cases import build
from ibr_ref.oracle.device import VULKAN
from ibr_ref.oracle.examination import examine
from ibr_ref.oracle.referees.displacement import model
from tests.oracle.tiny_cases import TINY


def test_jobs_come_back_in_their_order_and_see_only_the_numbers_before() -> None:
    machine = Bounds(VULKAN)
    machine.named("eye", machine.of(1.0).off_by(0.5))
    both = threading.Barrier(2, timeout=10.0)

    def job(k: int) -> tuple[int, tuple[str, ...]]:
        machine.begin(np.arange(1))
        number = machine.named("eye", machine.of(float(k)).off_by(0.5))
        if numba.get_num_threads() > 1 and k < 2:
            both.wait()  # two of them at a time, or this never ends
        return k, number.names

    found = [*machine.side_by_side([partial(job, k) for k in range(5)])]
    assert [k for k, _ in found] == [*range(5)]
    if numba.get_num_threads() > 1:
        assert {names for _, names in found} == {("eye 2",)}


def test_what_goes_wrong_in_a_job_is_told() -> None:
    def job(k: int) -> int:
        return 1 // (k - 2)

    with pytest.raises(ZeroDivisionError):
        [*Bounds(VULKAN).side_by_side([partial(job, k) for k in range(4)])]


@pytest.mark.parametrize("threads", [1, 2])
def test_a_verdict_is_the_same_on_any_threads_and_in_any_parts(threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    if threads > numba.config.NUMBA_NUM_THREADS:
        pytest.skip("one thread alone here")
    case = build("displacement-box")
    arrays = {"color": case.frame.color, "depth": case.frame.depth, **case.frame.stages}

    def judged() -> list[bytes]:
        found = examine(case, arrays, profile="ieee32")
        return [part.tobytes() for j in found.judgements for part in (j.wrong, j.undecided, j.width)]

    whole, before = judged(), numba.get_num_threads()
    monkeypatch.setattr(model, "CHUNK", 2000)
    monkeypatch.delitem(case.kept, "displacement.picture")
    numba.set_num_threads(threads)
    try:
        assert judged() == whole
    finally:
        numba.set_num_threads(before)


def test_a_judged_case_can_be_handed_to_another_process() -> None:
    """As `ibr_ref.view` does in a notebook: what referees keep, threads and all, stays here."""
    case = TINY["displacement-tile"]()
    examine(case, {"color": case.frame.color}, profile="ieee32")
    assert case.kept
    again = pickle.loads(pickle.dumps(case))
    assert again.kept == {}
    np.testing.assert_array_equal(again.frame.color, case.frame.color)
