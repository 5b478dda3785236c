"""The pytest plugin: every test that asks for `ibr_case` runs once for each case.

    def test_my_port(ibr_case):
        color, stages = my_port.draw(ibr_case.folder)
        ibr_case.check(color=color, stages=stages)

Options: `--ibr-cases "displacement-*"` picks cases by pattern, `--ibr-profile vulkan` declares the device,
`--ibr-reports DIR` keeps the reports. A test picks for itself with `@pytest.mark.ibr_cases("shadows-*", "splatting-rig")`.
Nothing of the oracle but the names of its devices is imported before a test asks for it.
"""

from __future__ import annotations

from collections.abc import Mapping
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from ibr_ref.oracle.cases.case import Case
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
        "--ibr-cases", metavar="PATTERN", default="*", help="cases for the fixture ibr_case: displacement-*"
    )
    group.addoption(
        "--ibr-profile", metavar="NAME", help=f"device profile that the port declares: {', '.join(PROFILES)}"
    )
    group.addoption("--ibr-reports", metavar="DIR", help="where reports of failures are written")


def pytest_configure(config: pytest.Config) -> None:
    """The plugin's marker."""
    config.addinivalue_line("markers", "ibr_cases(*patterns): run the test on the cases of ibr_ref with these names")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test for each case."""
    if "ibr_case" not in metafunc.fixturenames:
        return
    from ibr_ref.oracle.cases import names

    wanted = metafunc.config.getoption("--ibr-cases")
    marker = metafunc.definition.get_closest_marker("ibr_cases")
    patterns = marker.args if marker is not None else ("*",)
    chosen = [name for name in names() if fnmatchcase(name, wanted) and any(fnmatchcase(name, p) for p in patterns)]
    metafunc.parametrize("ibr_case", chosen, indirect=True)


@pytest.fixture
def ibr_case(request: pytest.FixtureRequest, tmp_path: Path) -> PortCase:
    """A case of ibr_ref for a port: draw it, then `ibr_case.check(color=..., stages={...})`."""
    from ibr_ref.oracle.cases import build

    reports = request.config.getoption("--ibr-reports")
    return PortCase(
        build(request.param),
        request.config.getoption("--ibr-profile"),
        tmp_path,
        Path(reports) if reports else tmp_path,
    )
