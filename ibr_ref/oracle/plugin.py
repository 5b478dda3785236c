"""The pytest plugin: every test that asks for `ibr_case` runs once for each case.

    def test_my_port(ibr_case):
        color, stages = my_port.draw(ibr_case.folder)
        ibr_case.check(color=color, stages=stages)

Options: `--ibr-cases "displacement-*"` picks cases by pattern, `--ibr-cases DIR` takes a case of one's own or a folder of
such, and several of these options add up; `--ibr-profile vulkan` declares the device, `--ibr-reports DIR` keeps the reports.
A test picks for itself with `@pytest.mark.ibr_cases("shadows-*", "splatting-rig", "my_cases")`. What chooses no case is an
error. Nothing of the oracle but the names of its devices is imported before a test asks for it.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from ibr_ref.oracle.cases.case import Case
    from ibr_ref.oracle.choice import Choice
    from ibr_ref.oracle.verdict import Verdict


class PortCase:
    """A case for a port's test: what to draw, and the judge of what was drawn."""

    def __init__(self, case: Case, profile: str | None, work: Path, reports: Path) -> None:
        self.case = case
        self._profile = profile
        self._work = work
        self._reports = reports

    @property
    def name(self) -> str:
        """Of the case: "displacement-box"."""
        return self.case.name

    @property
    def scene(self) -> Any:
        """The method's Scene."""
        return self.case.scene

    @property
    def params(self) -> Any:
        """The method's Params."""
        return self.case.params

    @property
    def inputs(self) -> dict[str, Any]:
        """What else a port is given: prepared maps, normal codes."""
        return self.case.inputs

    @cached_property
    def folder(self) -> Path:
        """The case exported, for ports that read files."""
        from ibr_ref import oracle

        folder = self._work / self.name
        oracle.export(self.case, folder)
        return folder

    def check(
        self,
        *,
        color: Any = None,
        depth: Any = None,
        stages: Mapping[str, Any] | None = None,
        profile: str | None = None,
    ) -> Verdict:
        """Judge arrays (NumPy, or anything with DLPack); the test fails unless the verdict is PASS.

        The failure says the verdict in words and where its report is. profile: instead of `--ibr-profile`.
        """
        from ibr_ref import oracle
        from ibr_ref.io.outputs import make_folder

        submission = oracle.submission_from_arrays(self.case, color=color, depth=depth, stages=stages)
        examination = oracle.check(self.case, submission, profile=profile or self._profile)
        verdict = examination.verdict
        if verdict.outcome is not type(verdict.outcome).PASS:
            make_folder(self._reports)
            path = self._reports / f"{self.name}.html"
            oracle.write_report(examination, path)
            pytest.fail(f"{verdict.words()}\n  Report: {path}", pytrace=False)
        return verdict


def pytest_addoption(parser: pytest.Parser) -> None:
    """The plugin's options."""
    from ibr_ref.oracle.device import PROFILES

    group = parser.getgroup("ibr_ref", "verdicts on ports of image-based rendering")
    group.addoption(
        "--ibr-cases",
        metavar="CASES",
        action="append",
        help="cases for the fixture ibr_case: displacement-*, or a folder of one's own; may be given several times",
    )
    group.addoption(
        "--ibr-profile", metavar="NAME", help=f"device profile that the port declares: {', '.join(PROFILES)}"
    )
    group.addoption("--ibr-reports", metavar="DIR", help="where reports of failures are written")


def pytest_configure(config: pytest.Config) -> None:
    """The plugin's marker. Raises UsageError for a `--ibr-cases` that chooses none."""
    config.addinivalue_line("markers", "ibr_cases(*cases): run the test on these cases of ibr_ref: patterns, folders")
    if config.getoption("--ibr-cases"):
        from ibr_ref.oracle.choice import chosen

        try:
            chosen(config.getoption("--ibr-cases"))
        except ValueError as error:
            raise pytest.UsageError(f"--ibr-cases: {error}") from None


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test for each case."""
    if "ibr_case" not in metafunc.fixturenames:
        return
    marker = metafunc.definition.get_closest_marker("ibr_cases")
    try:
        choices = _choices(metafunc.config.getoption("--ibr-cases"), None if marker is None else marker.args)
    except ValueError as error:
        raise pytest.Collector.CollectError(f"ibr_cases of {metafunc.function.__name__}: {error}") from None
    metafunc.parametrize("ibr_case", choices, indirect=True, ids=[choice.name for choice in choices])


def _choices(wanted: list[str] | None, marked: tuple[str, ...] | None) -> list[Choice]:
    """The cases that are wanted for all tests, of which a marker takes those of its patterns, and its own folders anyway.

    Raises ValueError for a word that chooses none.
    """
    from ibr_ref.oracle.choice import ALL, chosen

    found = chosen(wanted or [ALL])
    if marked is None:
        return found
    marked_choices = chosen(marked)  # or a typing error would be a green run
    patterns = [word for word in marked if not os.path.isdir(word)]
    taken = [
        choice
        for choice in found
        if any(word in (ALL, choice.name) or fnmatchcase(choice.name, word) for word in patterns)
    ]
    return taken + [each for each in marked_choices if each.folder is not None and each not in taken]


@pytest.fixture
def ibr_case(request: pytest.FixtureRequest, tmp_path: Path) -> PortCase:
    """A case of ibr_ref for a port: draw it, then `ibr_case.check(color=..., stages={...})`."""
    choice: Choice = request.param
    case = choice.make()
    if choice.folder is not None:
        from ibr_ref.oracle.files import outdated

        if (warning := outdated(case, choice.folder)) is not None:
            warnings.warn(warning, stacklevel=1)
    reports = request.config.getoption("--ibr-reports")
    return PortCase(
        case,
        request.config.getoption("--ibr-profile"),
        tmp_path,
        Path(reports) if reports else tmp_path,
    )
