"""The pytest plugin in a port author's own test files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from ibr_ref import oracle
from ibr_ref.oracle import report
from tests.oracle.files.older import older
from tests.oracle.tiny_cases import TINY

pytest_plugins = "pytester"

Run = Callable[..., pytest.RunResult]

RIGHT = """
def test_port(ibr_case):
    frame = ibr_case.case.frame
    verdict = ibr_case.check(color=frame.color, depth=frame.depth, stages=frame.stages)
    assert verdict.outcome == "PASS"
"""

WRONG = """
def test_port(ibr_case):
    color = ibr_case.case.frame.color.copy()
    color[30:34, 40:50] = (1.0, 0.0, 1.0)
    ibr_case.check(color=color)
"""


@pytest.fixture(scope="module")
def loaded() -> None:
    """All modules of a verdict and its report: what only an inner run imports is forgotten after it, which Numba minds."""
    case = oracle.build("splatting-ball")
    report.page(oracle.check(case, oracle.submission_from_arrays(case, color=0.5 * case.frame.color)))


@pytest.fixture
def run(loaded: None, pytester: pytest.Pytester, pytestconfig: pytest.Config) -> Run:
    """pytest with the plugin, whether this installation has the entry point yet or not; the first argument is the file."""
    plugin = () if pytestconfig.pluginmanager.has_plugin("ibr_ref") else ("-p", "ibr_ref.oracle.plugin")

    def result(file: str, *options: str) -> pytest.RunResult:
        pytester.makepyfile(file)
        return pytester.runpytest(*plugin, *options)

    return result


def cases_of(result: pytest.RunResult) -> list[str]:
    """Of collected tests."""
    return [line.partition("[")[2].removesuffix("]") for line in result.outlines if "::" in line]


def test_a_right_port_passes_on_the_cases_that_are_asked_for(run: Run) -> None:
    result = run(RIGHT, "--ibr-cases", "splatting-[bd]*", "-v")
    result.assert_outcomes(passed=3)
    result.stdout.fnmatch_lines(["*test_port?splatting-ball? PASSED*", "*test_port?splatting-discs? PASSED*"])


def test_without_an_option_it_runs_on_all(run: Run) -> None:
    result = run(RIGHT, "--collect-only", "-q")
    assert cases_of(result) == oracle.names()


@pytest.mark.parametrize(
    ("options", "marker", "chosen"),
    [
        ((), '"splatting-ball"', ["splatting-ball"]),
        ((), '"splatting-ball", "splatting-q*"', ["splatting-ball", "splatting-quads"]),
        (("--ibr-cases", "*-quads"), '"splatting-ball", "splatting-q*"', ["splatting-quads"]),
    ],
)
def test_a_test_picks_its_cases_by_the_marker(
    run: Run, options: tuple[str, ...], marker: str, chosen: list[str]
) -> None:
    result = run(
        f"import pytest\n\n@pytest.mark.ibr_cases({marker})\ndef test_port(ibr_case): pass",
        "--collect-only",
        "-q",
        "--strict-markers",
        *options,
    )
    assert cases_of(result) == chosen


def test_a_failure_has_the_verdict_s_words_and_the_report(run: Run, tmp_path: Path) -> None:
    reports = tmp_path / "kept" / "reports"
    result = run(WRONG, "--ibr-cases", "splatting-ball", "--ibr-reports", str(reports))
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        [
            "FAIL: splatting-ball, first wrong in stage image*",
            "*image: 40 pixels wrong*",
            "*Witness: pixel*",
            f"*Report: {reports / 'splatting-ball.html'}",
        ]
    )
    assert "Traceback" not in result.stdout.str()
    page = (reports / "splatting-ball.html").read_text("utf-8")
    assert "FAIL" in page
    assert "40 pixels wrong" in page


def test_the_report_lies_in_the_test_s_own_folder_if_no_place_is_named(run: Run) -> None:
    result = run(WRONG, "--ibr-cases", "splatting-ball")
    # pytest repeats the message in its summary where CI runs it.
    (line,) = {line for line in result.outlines if line.startswith("  Report: ")}
    assert Path(line.removeprefix("  Report: ")).is_file()


@pytest.mark.parametrize("options", [["splating-*"], ["splatting-*", "nowhere/at/all"]])
def test_a_pattern_that_chooses_nothing_is_an_error(run: Run, options: list[str]) -> None:
    result = run(RIGHT, *(word for option in options for word in ("--ibr-cases", option)))
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines([f"ERROR: --ibr-cases: case: found '{options[-1]}', allowed: *"])


def test_so_is_a_marker_s(run: Run) -> None:
    result = run('import pytest\n\n@pytest.mark.ibr_cases("shadow-*")\ndef test_port(ibr_case): pass')
    assert result.ret not in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED)
    result.stdout.fnmatch_lines(["*ibr_cases of test_port: case: found 'shadow-*', allowed: *"])


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """A folder with two cases of one's own, of which one was made by another version."""
    for name in ("splatting-dots", "displacement-hill"):
        oracle.export(TINY[name](), tmp_path / "own" / name)
    older(tmp_path / "own" / "splatting-dots")
    return tmp_path / "own"


def test_folders_of_ones_own(run: Run, own: Path) -> None:
    result = run(RIGHT, "--ibr-cases", str(own), "-v", "-W", "default")
    result.assert_outcomes(passed=2, warnings=1)
    result.stdout.fnmatch_lines(
        ["*1 of * expected arrays (depth), made by another 0.0.1, are not what ibr_ref * draws*"]
    )
    result = run(RIGHT, "--ibr-cases", str(own / "displacement-hill"), "--ibr-cases", "*-ball", "--collect-only", "-q")
    assert cases_of(result) == ["displacement-hill", "splatting-ball"]


def test_a_marker_takes_a_folder_beside_patterns(run: Run, own: Path) -> None:
    marked = f'@pytest.mark.ibr_cases("splatting-ball", {str(own)!r})'
    result = run(f"import pytest\n\n{marked}\ndef test_port(ibr_case): pass", "--collect-only", "-q")
    assert cases_of(result) == ["splatting-ball", "displacement-hill", "splatting-dots"]


UNUSABLE = """
def test_shape(ibr_case):
    ibr_case.check(color=ibr_case.case.frame.color[1:])

def test_nothing(ibr_case):
    ibr_case.check()
"""


def test_what_cannot_be_judged_fails(run: Run) -> None:
    result = run(UNUSABLE, "--ibr-cases", "splatting-ball")
    result.assert_outcomes(failed=2)
    result.stdout.fnmatch_lines(
        ["INCONCLUSIVE: splatting-ball*", "*color: found the shape*", "*found neither a final image nor a stage*"]
    )


FROM_THE_FOLDER = """
import json
import numpy as np

def test_port(ibr_case):
    document = json.loads((ibr_case.folder / "case.json").read_text())
    assert document["name"] == ibr_case.name == "splatting-ball"
    assert document["params"]["alpha"] == ibr_case.params.alpha
    assert len(document["scene"]["images"]) == len(ibr_case.scene.images) == len(ibr_case.inputs["normals"])
    color = np.load(ibr_case.folder / "expected" / "color.npy")
    assert ibr_case.check(color=color.astype(np.float32)).profile == "ieee32"
"""


def test_a_port_reads_the_folder(run: Run) -> None:
    run(FROM_THE_FOLDER, "--ibr-cases", "splatting-ball").assert_outcomes(passed=1)


TENSORS = """
class Tensor:
    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()

def test_port(ibr_case):
    frame = ibr_case.case.frame
    stages = {"raster.splat": Tensor(frame.stages["raster.splat"])}
    verdict = ibr_case.check(color=Tensor(frame.color), depth=Tensor(frame.depth), stages=stages)
    assert (verdict.profile, verdict.declared) == ("vulkan", True)
    assert ibr_case.check(color=Tensor(frame.color), profile="gl").profile == "gl"
"""


def test_arrays_of_other_libraries_and_a_declared_device(run: Run) -> None:
    result = run(TENSORS, "--ibr-cases", "splatting-ball", "--ibr-profile", "vulkan")
    result.assert_outcomes(passed=1)
