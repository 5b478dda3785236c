"""Witnesses: the right element, the right array, and the numbers that were compared."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

import numpy as np
import pytest

from ibr_ref import oracle
from ibr_ref.oracle.examination import Examination
from ibr_ref.oracle.findings import Outcome, Witness
from ibr_ref.oracle.report import page
from ibr_ref.oracle.verdict import Verdict
from ibr_ref.oracle.words import MOST_LINES
from tests.oracle.tiny_cases import TINY, handed_of

Arrays = dict[str, Any]


@cache
def reference(name: str) -> Arrays:
    return handed_of(TINY[name]())


def copied(name: str) -> Arrays:
    return {n: tuple(p.copy() for p in a) if isinstance(a, tuple) else a.copy() for n, a in reference(name).items()}


def checked(name: str, handed: Arrays, profile: str | None = "ieee32") -> Examination:
    case, picture = TINY[name](), {n: handed[n] for n in ("color", "depth") if n in handed}
    stages = {n: a for n, a in handed.items() if n not in picture}
    submission = oracle.submission_from_arrays(case, stages=stages, **picture)
    return oracle.check(case, submission, profile=profile, name_causes=False)


def verdict(name: str, handed: Arrays, profile: str | None = "ieee32") -> Verdict:
    return checked(name, handed, profile).verdict


def numbers(text: str) -> list[float]:
    """Of a headline: flags as 0 and 1."""
    text = text.replace("True", "1").replace("False", "0")
    return [float(n) for n in re.findall(r"nan|-?inf|-?\d+\.?\d*(?:e[-+]?\d+)?", text.partition(" / 255")[0])]


def at(array: Any, index: tuple[int, ...]) -> list[float]:
    found = array[index[0]][index[1:]] if isinstance(array, tuple) else array[index]
    return np.ravel(found).astype(np.float64).tolist()


def witness_of(found: Verdict, stage: str) -> Witness:
    return next(w for w in found.witnesses if w.stage == stage)


def spoiled(array: Any, random: np.random.Generator) -> tuple[int, ...]:
    """Change one element; its index, of pages with the page first."""
    page_ = int(random.integers(len(array))) if isinstance(array, tuple) else None
    numbers_ = array[page_] if page_ is not None else array
    places = np.argwhere(np.isfinite(numbers_.astype(np.float64)))
    index = tuple(int(i) for i in places[random.integers(len(places))])
    if numbers_.dtype.kind == "b":
        numbers_[index] = not numbers_[index]
    elif numbers_.dtype.kind in "iu":
        numbers_[index] += 1 if numbers_[index] < 250 else -1
    else:
        numbers_[index] += 0.25
    return index if page_ is None else (page_, *index)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", TINY)
def test_one_wrong_element_of_any_array_heads_its_witness(name: str) -> None:
    """In the right place, with what the arrays have there."""
    random = np.random.default_rng(2)
    for array in reference(name):
        handed = copied(name)
        where = spoiled(handed[array], random)
        found = verdict(name, handed).witness
        assert found is not None, array
        assert found.array == array
        assert where[: len(found.index)] == found.index, (array, where)
        assert numbers(found.port) == pytest.approx(at(handed[array], found.index), rel=1e-8), array
        expected = at(reference(name)[array], found.index)
        assert numbers(found.reference) == pytest.approx(expected, rel=1e-7, abs=1e-8), array
        assert found.reference != found.port
        told = [step for step in found.trace if (step.reference, step.port) == (found.reference, found.port)]
        assert told, "the trace compares other numbers"
        assert any("differs" in step.note for step in told)


REPLAYED = [
    ("shadows-many", {"project.shadow": 0.4}, ("project.shadow", "accumulate.shadow"), "accumulate", 2 / 5),
    ("shadows-warp", {"accumulate.shadow": 1.0}, ("accumulate.shadow", "color"), "resolve", None),
    ("splatting-dots", {"vertex.color": 0.25}, ("vertex.color", "raster.splat", "color"), "resolve", 0.25),
    ("displacement-hill", {"shade.lit": False, "shade.albedo": 0.0, "shade.normal": 0.0},
     ("shade.albedo", "shade.normal", "shade.lit", "march.hit_index", "march.hit", "march.steep", "color"), "shade", None),
]  # fmt: skip


@pytest.mark.parametrize(("name", "changes", "kept", "stage", "expected"), REPLAYED, ids=[r[0] for r in REPLAYED])
def test_the_reference_in_a_headline_is_the_replayed_one(
    name: str, changes: Arrays, kept: tuple[str, ...], stage: str, expected: float | None
) -> None:
    """The stage is fed with the port's own arrays, and so is what heads its witness."""
    handed = {n: a for n, a in copied(name).items() if n in kept}
    for array, value in changes.items():
        handed[array][...] = value
    found = witness_of(verdict(name, handed, "gl"), stage)
    if expected is not None:
        assert numbers(found.reference) == pytest.approx([expected] * len(numbers(found.reference)), abs=0.01)
        assert numbers(found.reference) != pytest.approx(at(reference(name)[found.array], found.index), abs=0.01)
    assert any((step.reference, step.port) == (found.reference, found.port) for step in found.trace)
    assert numbers(found.port) == pytest.approx(at(handed[found.array], found.index), rel=1e-8)


def test_every_wrong_stage_has_its_witness_in_words_json_and_page() -> None:
    name = "shadows-many"
    handed = copied(name)
    handed["color"] *= 0.5
    for array in ("controls", "warp.grid", "project.shadow", "accumulate.shadow"):
        handed[array][...] = 0.3
    examination = checked(name, handed)
    found = examination.verdict
    wrong = [stage for stage in found.stages if not stage.right]
    assert len(wrong) >= 6
    assert [w.stage for w in found.witnesses] == [stage.stage for stage in wrong]
    assert found.witness == wrong[0].witness
    assert found.words().count("  Witness") == len(wrong)
    assert Verdict.model_validate_json(found.model_dump_json()) == found
    text = page(examination)
    for one in found.witnesses:
        assert f"<h2>Witness of {one.stage}: {one.element} {list(one.index)} of {one.array}</h2>" in text


def test_a_long_trace_is_folded_in_words_and_on_the_page() -> None:
    name = "displacement-pair"
    handed = {n: a for n, a in copied(name).items() if n in ("color", "depth")}
    row, column = np.argwhere(handed["depth"] < 1.0)[40]
    handed["color"][row, column] = (0.9, 0.0, 0.9)
    examination = checked(name, handed)
    found = witness_of(examination.verdict, "image")
    assert len(found.trace) > MOST_LINES
    lines = examination.verdict.words().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("  Witness"))
    shown = lines[start + 1 : next(i for i, line in enumerate(lines) if i > start and not line.startswith("    "))]
    assert len(shown) <= MOST_LINES
    hidden = sum(int(re.findall(r"\.\.\. ([\d,]+) more", line)[0]) for line in shown if "... " in line)
    assert hidden + sum("... " not in line for line in shown) == len(found.trace)
    assert any(line.endswith("differs") for line in shown)
    assert f"<details>\n  <summary>How it is computed: {len(found.trace)} steps" in page(examination)
    one = copied("shadows-many")
    one["controls"][0, 0, 0, 0] = 0.3
    assert "<details open>" in page(checked("shadows-many", one))


def test_what_is_computed_first_is_blamed_first() -> None:
    handed = copied("splatting-dots")
    handed["vertex.window"] += 3.0
    handed["vertex.width"] *= 1.5
    found = verdict("splatting-dots", handed).witness
    assert found is not None
    assert found.array == "vertex.window"
    handed = copied("displacement-hill")
    handed["vertex.patch"] += 0.1
    handed["vertex.clip"] += 0.1
    found = verdict("displacement-hill", handed).witness
    assert found is not None
    assert found.array == "vertex.patch"


@pytest.mark.parametrize("name", ["displacement-hill", "splatting-dots", "shadows-warp"])
def test_of_a_picture_the_surface_is_blamed_before_its_colour(name: str) -> None:
    handed = {n: a for n, a in copied(name).items() if n in ("color", "depth")}
    seen = tuple(np.argwhere(handed["depth"] < 1.0)[20])
    handed["depth"][seen] *= 0.5
    handed["color"][seen] = (0.9, 0.0, 0.9)
    found = verdict(name, handed).witness
    assert found is not None
    assert (found.array, found.index) == ("depth", seen)


def test_sums_in_8_bits_are_bytes() -> None:
    """Whatever lies between two of them no buffer holds, however loose the device."""
    name = "shadows-many"
    for kept in (("accumulate.shadow",), ("project.shadow", "accumulate.shadow")):
        handed = {n: a for n, a in copied(name).items() if n in kept}
        assert verdict(name, handed, "gl").outcome is Outcome.PASS
        single = {n: a.astype(np.float32) for n, a in handed.items()}
        assert verdict(name, single).outcome is Outcome.PASS
        handed["accumulate.shadow"] += np.where(handed["accumulate.shadow"] > 0.1, 0.3 / 255.0, 0.0)
        found = verdict(name, handed, "gl")
        assert found.outcome is Outcome.FAIL
        assert found.first_wrong_stage == "accumulate"
        assert found.witness is not None
        assert any("a byte k / 255" in step.step and step.note == "differs" for step in found.witness.trace)


def test_discs_are_tested_as_discs() -> None:
    name = "splatting-round_dots"
    handed = copied(name)
    splats = handed["raster.splat"]
    handed["raster.depth"][splats >= 0] *= 0.9
    found = verdict(name, handed).witness
    assert found is not None
    tests = [step for step in found.trace if "dx^2 + dy^2" in step.step]
    assert tests
    assert all(step.margin is not None and step.bound is not None for step in tests)
    winner = int(splats[found.index])
    assert next(step for step in tests if step.step.startswith(f"splat {winner}:")).reference == "yes"


def test_a_hit_before_the_near_plane_is_no_legal_outcome() -> None:
    name = "displacement-cut"
    handed = copied(name)
    stages = reference(name)
    random, cut = np.random.default_rng(0), 0
    lost = np.argwhere((stages["raster.face"] >= 0) & (stages["march.hit_index"] < 0))
    for row, column in lost[random.permutation(len(lost))[:12]]:
        here = {n: a.copy() for n, a in handed.items()}
        here["march.linear_index"][row, column] = here["march.hit_index"][row, column] = 1
        here["march.hit"][row, column] = (0.5, 0.5, 0.5)
        found = witness_of(verdict(name, here), "march")
        planes = [step for step in found.trace if "near plane" in step.step and step.reference == "no: discarded"]
        outcomes = [step for step in found.trace if step.step.startswith("a legal outcome")]
        if not planes:
            continue
        cut += 1
        assert outcomes
        assert all(step.reference.startswith("-1, -1,") for step in outcomes)
        assert found.reference == "-1"
    assert cut, "no pixel whose hit lies before the near plane"


FACES = [
    ("missing", lambda a: np.delete(a, range(4, 8), axis=0), 1, "polygon 0, u=0", "nothing"),
    ("twice", lambda a: np.concatenate([a, a[4:8]]), 3, "nothing", "polygon 0, u=0"),
    ("none", lambda a: a[:0], 0, "polygon 0, base", "nothing"),
]


@pytest.mark.parametrize("arrays", [("vertex.clip", "vertex.patch"), ("vertex.clip",), ("vertex.patch",)], ids=str)
@pytest.mark.parametrize("fault", FACES, ids=[fault[0] for fault in FACES])
def test_too_many_or_too_few_faces_fail_by_name(fault: Any, arrays: tuple[str, ...]) -> None:
    _, change, index, ours, theirs = fault
    name = "displacement-hill"
    handed = copied(name)
    for array in arrays:
        handed[array] = change(handed[array])
    found = verdict(name, handed)
    assert (found.outcome, found.first_wrong_stage) == (Outcome.FAIL, "vertex")
    assert found.witness is not None
    assert (found.witness.element, found.witness.index) == ("face", (index,))
    short = [text.replace("polygon 0, ", "") for text in (ours, theirs)]
    assert [text.replace("polygon 0, ", "") for text in (found.witness.reference, found.witness.port)] == short


def test_rows_that_are_no_faces_cannot_be_judged() -> None:
    handed = copied("displacement-hill")
    handed["vertex.clip"] = handed["vertex.clip"][:-1]
    found = verdict("displacement-hill", handed)
    assert found.outcome is Outcome.INCONCLUSIVE
    assert "four rows a face" in found.words()
