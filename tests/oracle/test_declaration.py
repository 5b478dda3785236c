"""What a port may say of its device, and what is found out where it says nothing."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref import oracle
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.declaration import ANY, ARITHMETIC, FILTER_BYTES, NUMBERS, Declaration, declared, device_of
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.findings import Outcome
from ibr_ref.oracle.self_test import plain_port


def drawn(name: str, policy: Policy, port: Any = None) -> tuple[oracle.Case, dict[str, Any]]:
    """A plain port's arrays of a case."""
    case = oracle.build(name)
    return case, (port or plain_port(case.method).Port)(case.scene, case.params, policy, case.inputs).render()


@pytest.mark.parametrize(
    ("text", "profile", "numbers"),
    [
        ("vulkan", "vulkan", {}),
        ("gl,subpixel_bits=4", "gl", {"subpixel_bits": 4}),
        ("subpixel_bits=4, filter_result=unorm8", None, {"subpixel_bits": 4, "filter_result": "unorm8"}),
        ("d3d11,depth_format=float32", "d3d11", {"depth_format": "float32"}),
        ("gl,operation_ulps=0.5,root_ulps=2", "gl", {"operation_ulps": 0.5, "root_ulps": 2}),
    ],
)
def test_texts(text: str, profile: str | None, numbers: dict[str, Any]) -> None:
    assert declared(text) == Declaration(profile, numbers)


def test_files(tmp_path: Path) -> None:
    path = tmp_path / "device.json"
    path.write_text(json.dumps({"profile": "gl", "subpixel_bits": 4}))
    assert declared(str(path)) == declared("gl,subpixel_bits=4")
    path.write_text("{}")
    assert declared(str(path)) == ANY
    assert not declared(str(path))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("opengl", "device: found 'opengl', allowed: ieee32 | d3d11"),
        ("gl,vulkan", "device: found 'gl,vulkan', allowed: one profile"),
        ("gl,bits=4", "device: found 'bits', allowed: subpixel_bits | "),
        ("gl,subpixel_bits=3", "subpixel_bits: found 3, allowed: 4 to 16"),
        ("gl,subpixel_bits=four", "subpixel_bits: found 'four', allowed: 4 to 16"),
        ("gl,filter_result=unorm16", "filter_result: found 'unorm16', allowed: float | unorm8"),
        ("gl,quotient_ulps=0.4", "quotient_ulps: found 0.4, allowed: 0.5 to 64"),
        ("gl,quotient_ulps=1e3", "quotient_ulps: found '1e3', allowed: 0.5 to 64"),
        ("gl,power_ulps=nan", "power_ulps: found 'nan', allowed: 0.5 to 64"),
        ("gl,varyings=any", "varyings: found 'any', allowed: snapped | unsnapped | either"),
        ("gl,subpixel_bits=4,subpixel_bits=8", "device: found 'subpixel_bits twice', allowed: each number once"),
        ("", "device: found '', allowed: ieee32 | "),
    ],
)
def test_what_is_none(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
        declared(text)


@pytest.mark.parametrize(
    "text",
    [
        "[]",
        "nothing",
        '{"profile": 4}',
        '{"subpixel_bits": 4.0}',
        '{"subpixel_bits": true}',
        '{"root_ulps": true}',
        '{"root_ulps": "1"}',
        '{"root_ulps": NaN}',
        '{"root_ulps": 65}',
        "[" * 9999,
    ],
)
def test_bad_files_are_one_line(text: str, tmp_path: Path) -> None:
    path = tmp_path / "device.json"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"device\.json: .*allowed: ") as error:
        declared(str(path))
    assert "\n" not in str(error.value)
    with pytest.raises(OSError, match=r"none\.json"):
        declared(str(tmp_path / "none.json"))


def test_numbers_change_what_they_say() -> None:
    gl, changed = PROFILES["gl"], device_of("gl,subpixel_bits=4,filter_result=unorm8,clip_z=zero_to_one")
    assert changed.words == "gl,subpixel_bits=4,filter_result=unorm8,clip_z=zero_to_one"
    assert (changed.snap, changed.splat_border) == (16 * gl.snap, 16 * gl.splat_border)
    assert (changed.filter_step, changed.minus_one) == (FILTER_BYTES, False)
    same = device_of("gl,subpixel_bits=8,texel_weight_bits=8,filter_result=float,varyings=either,unorm_rounding=either")
    assert {**vars(same), "numbers": {}} == vars(gl)
    assert all(number.meaning for number in NUMBERS.values())


def test_the_arithmetic_is_declared_in_units_in_the_last_place() -> None:
    """Of which the profiles have halves."""
    text = "operation_ulps=0.5,quotient_ulps=2.5,root_ulps=1,power_ulps=3"
    device = device_of(f"gl,{text}")
    assert device.words == f"gl,{text}"
    assert (device.operation, device.quotient, device.root) == (
        1.0,
        PROFILES["vulkan"].quotient,
        PROFILES["d3d11"].root,
    )
    assert (device.logarithm, device.exponential) == (6.0, 6.0)
    correct = declared(",".join(f"{name}=0.5" for name in ARITHMETIC)).device("gl")
    fields = ("operation", "quotient", "root", "logarithm", "exponential")
    assert [getattr(correct, name) for name in fields] == [getattr(PROFILES["ieee32"], name) for name in fields]


def test_texture_units_that_wrap_are_as_the_profile_has_them() -> None:
    """SwiftShader's shaders round correctly, and its repeated facades are a bound's tenth farther off than that."""
    gl = PROFILES["gl"]
    assert device_of("gl,operation_ulps=0.5").wrapping == gl.operation - 1.0
    assert [device.wrapping for device in PROFILES.values()] == [0.0] * len(PROFILES)
    assert device_of("vulkan,operation_ulps=0.5").wrapping == 0.0


def test_what_varyings_are_interpolated_over() -> None:
    for over, found in {"snapped": (True, False), "unsnapped": (False, True), "either": (True, True)}.items():
        device = device_of(f"gl,varyings={over}")
        assert (device.snapped, device.unsnapped) == found
    assert all(device.snapped for device in PROFILES.values())


COARSE = Policy(subpixel_bits=4, subpixel_rounding="down")


@pytest.mark.parametrize("name", ["splatting-quads", "shadows-coarse"])
def test_a_right_port_of_four_bits_passes(name: str) -> None:
    """Undeclared by what is found, declared by what is said; as a desktop's it is wrong, and told what it lacks."""
    case, arrays = drawn(name, COARSE)
    found = oracle.examine(case, arrays).verdict
    assert (found.outcome, found.numbers) == (Outcome.PASS, {"subpixel_bits": 4})
    assert f"{found.profile},subpixel_bits=4 (the tightest)" in found.words()
    assert oracle.examine(case, arrays, profile="gl,subpixel_bits=4").verdict.outcome is Outcome.PASS
    failed = oracle.examine(case, arrays, profile="gl", name_causes=False).verdict
    assert (failed.outcome, failed.needs) == (Outcome.FAIL, {"subpixel_bits": 4})
    assert "would be right with subpixel_bits=4: declare it if your device has it." in failed.words()


@pytest.mark.parametrize("bits", [4, 6, 11, 16])
@pytest.mark.parametrize("profile", ["ieee32", "d3d11", "gl"])
def test_splats_on_any_raster(profile: str, bits: int) -> None:
    """By ieee32 their centres were taken for snapped to 1/256 whatever was declared, and by others on finer rasters."""
    for name in ("splatting-discs", "splatting-sprites", "splatting-quads"):
        case, arrays = drawn(name, Policy(subpixel_bits=bits))
        found = oracle.examine(case, arrays, profile=f"{profile},subpixel_bits={bits}", name_causes=False).verdict
        assert found.outcome is Outcome.PASS, name


@pytest.mark.long
def test_a_right_port_that_filters_bytes_in_bytes_passes() -> None:
    case, arrays = drawn("displacement-low", Policy(filtered_bytes=True, weight_bits=8))
    found = oracle.examine(case, arrays).verdict
    assert (found.outcome, found.numbers) == (Outcome.PASS, {"filter_result": "unorm8"})


def test_what_no_number_explains_is_judged_by_the_loosest_profile() -> None:
    case, arrays = drawn("splatting-quads", COARSE)
    arrays["color"] = np.clip(arrays["color"] + 0.1, 0.0, 1.0)
    verdict = oracle.examine(case, arrays).verdict
    assert (verdict.outcome, verdict.profile, verdict.numbers) == (Outcome.FAIL, "gl", {})
    assert verdict.needs == {"subpixel_bits": 4}  # of the stage raster; the colours are wrong on any device
    declared_right = oracle.examine(case, arrays, profile="gl,subpixel_bits=4").verdict
    assert (declared_right.first_wrong_stage, declared_right.needs) == ("resolve", {})


def test_numbers_alone_leave_the_profile_open() -> None:
    case, arrays = drawn("splatting-quads", COARSE)
    verdict = oracle.examine(case, arrays, profile="subpixel_bits=4").verdict
    assert (verdict.outcome, verdict.declared) == (Outcome.PASS, False)
    assert {name.partition(",")[2] for name in verdict.tried} == {"subpixel_bits=4"}


def test_a_port_json_declares(tmp_path: Path) -> None:
    case, arrays = drawn("splatting-quads", COARSE)
    np.save(tmp_path / "color.npy", arrays["color"])
    (tmp_path / "port.json").write_text('{"profile": "gl", "subpixel_bits": 4}')
    submission = oracle.load_submission(tmp_path, case)
    assert submission.declaration == declared("gl,subpixel_bits=4")
    assert oracle.check(case, submission).verdict.device == "gl,subpixel_bits=4"
    (tmp_path / "port.json").write_text('{"profile": "gl", "subpixel_bits": 2}')
    (problem,) = oracle.load_submission(tmp_path, case).problems
    assert str(problem) == "port.json: subpixel_bits: found 2, allowed: 4 to 16"
