"""Which profile a verdict rests on, for every set of devices that may explain a port; and which are not even tried."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.declaration import declared
from ibr_ref.oracle.device import LOOSEST, PROFILES, Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.trials import Trial, judge, needed, tightest
from tests.oracle.plain_referee import PlainReferee, box_case

STAGES = {"raster.face": np.zeros(1), "march.steep": np.zeros(1)}


class Explaining(PlainReferee):
    """Every stage and the picture are right by some devices, and wrong by the others; keeps account of what it judged."""

    def __init__(self, names: tuple[str, ...]) -> None:
        self.names = names
        self.asked: list[tuple[str, str]] = []

    def _judge(self, stage: str, case: Case, device: Device, handed: Handed, names: tuple[str, ...]) -> Judgement:
        self.asked.append((device.name, stage))
        wrong = np.array([device.name not in self.names])
        blame = np.where(wrong, 0, -1).astype(np.int8)
        nothing, width = np.zeros(1, np.bool_), np.zeros(1)
        return Judgement(
            stage=stage, element="pixel", arrays=names, wrong=wrong, undecided=nothing, width=width, blame=blame
        )


SETS = [(*some, LOOSEST) for n in range(len(PROFILES)) for some in combinations(list(PROFILES)[:-1], n)]
"""What the loosest does not explain nothing does: it grants the most."""


@pytest.mark.parametrize("explaining", SETS, ids="-".join)
def test_the_tightest_that_explains_is_found(explaining: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    referee = Explaining(explaining)
    monkeypatch.setattr("ibr_ref.oracle.trials.referee", lambda method: referee)
    found, tried = tightest(box_case(), {**STAGES, "color": np.zeros(1)})
    assert found.device.name == min(explaining, key=lambda name: PROFILES[name].rank)
    assert [j.stage for j in found.judgements] == ["raster", "march", "image"]
    assert {name for name, wrong in tried.items() if not wrong} <= {*explaining}
    for name in {*tried} - {*explaining}:  # a trial ends where it fails
        assert [stage for device, stage in referee.asked if device == name] == ["raster"]


@pytest.mark.parametrize("explaining", SETS, ids="-".join)
def test_of_a_picture_alone_too(explaining: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ibr_ref.oracle.trials.referee", lambda method: Explaining(explaining))
    found, _ = tightest(box_case(), {"color": np.zeros(1)})
    assert found.device.name == min(explaining, key=lambda name: PROFILES[name].rank)
    assert [j.stage for j in found.judgements] == ["image"]


def test_what_no_device_explains_is_judged_whole_by_the_loosest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ibr_ref.oracle.trials.referee", lambda method: Explaining(()))
    found, tried = tightest(box_case(), {**STAGES, "color": np.zeros(1)})
    assert (found.device.name, found.wrong) == ("gl", 3)
    most = "gl,subpixel_bits=4,filter_result=unorm8"
    assert tried == {"ieee32": 1, "d3d11": 1, "gl": 3, most: 1}
    assert tightest(box_case(), {"color": np.zeros(1)})[1] == {"gl": 1, most: 1}


class Coarse(Explaining):
    """What devices with some numbers explain, whatever their profile."""

    def _judge(self, stage: str, case: Case, device: Device, handed: Handed, names: tuple[str, ...]) -> Judgement:
        self.asked.append((device.words, stage))
        fits = {f"{key}={value}" for key, value in device.numbers.items()} >= {*self.names}
        wrong = np.array([not fits])
        blame = np.where(wrong, 0, -1).astype(np.int8)
        nothing, width = np.zeros(1, np.bool_), np.zeros(1)
        return Judgement(
            stage=stage, element="pixel", arrays=names, wrong=wrong, undecided=nothing, width=width, blame=blame
        )


@pytest.mark.parametrize(
    "numbers", [("subpixel_bits=4",), ("filter_result=unorm8",), ("subpixel_bits=4", "filter_result=unorm8")], ids=str
)
def test_as_few_numbers_as_will_do_are_found(numbers: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ibr_ref.oracle.trials.referee", lambda method: Coarse(numbers))
    found, _ = tightest(box_case(), {**STAGES, "color": np.zeros(1)})
    assert (found.device.words, found.wrong) == (",".join(["ieee32", *numbers]), 0)


def test_no_number_is_tried_that_was_declared(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ibr_ref.oracle.trials.referee", lambda method: Coarse(("subpixel_bits=4",)))
    found, tried = tightest(box_case(), {**STAGES, "color": np.zeros(1)}, declared("subpixel_bits=8"))
    assert (found.device.words, found.wrong) == ("gl,subpixel_bits=8", 3)
    assert list(tried)[-1] == "gl,subpixel_bits=8,filter_result=unorm8"
    assert needed(box_case(), {**STAGES, "color": np.zeros(1)}, found) == {}


def test_what_the_first_wrong_stage_would_need(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ibr_ref.oracle.trials.referee", lambda method: Coarse(("filter_result=unorm8",)))
    handed = {**STAGES, "color": np.zeros(1)}
    failed = Trial(PROFILES["gl"], judge(box_case(), handed, PROFILES["gl"]))
    assert needed(box_case(), handed, failed) == {"filter_result": "unorm8"}


@pytest.mark.parametrize("numbers", [("depth_format=unorm16",), ("varyings=either", "clip_border=allowed")], ids=str)
def test_what_a_declared_device_has_too_little_of(numbers: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ibr_ref.oracle.trials.referee", lambda method: Coarse(numbers))
    handed = {**STAGES, "color": np.zeros(1)}
    failed = Trial(PROFILES["d3d11"], judge(box_case(), handed, PROFILES["d3d11"]))
    assert needed(box_case(), handed, failed) == {}
    found = needed(box_case(), handed, failed, limits=True)
    assert tuple(f"{name}={value}" for name, value in found.items()) == numbers


def test_the_loosest_grants_what_any_other_does() -> None:
    loosest = PROFILES[LOOSEST]
    for device in PROFILES.values():
        numbers = set(device.sources)
        assert numbers == set(vars(device)) - {"name", "rank", "likely", "sources", "numbers"}
        assert device.subpixel_bits == loosest.subpixel_bits
        assert all(getattr(device, name) <= getattr(loosest, name) for name in numbers), device.name


def test_the_order_is_that_of_the_ranks() -> None:
    ranks = [device.rank for device in PROFILES.values()]
    assert ranks == sorted(set(ranks))
    assert PROFILES[LOOSEST].rank == ranks[-1]


@pytest.mark.parametrize("kept", [("color",), ("color", "depth"), ("depth",), ("march.steep",)])
def test_a_picture_without_stages_is_judged_alone(kept: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    referee = Explaining(("gl",))
    monkeypatch.setattr("ibr_ref.oracle.trials.referee", lambda method: referee)
    judge(box_case(), {name: np.zeros(1) for name in kept}, PROFILES["gl"])
    expected = {"color": "image", "march.steep": "march"}
    assert [stage for _, stage in referee.asked] == [expected[name] for name in kept if name in expected]
