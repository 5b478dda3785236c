"""Verdicts on ports: whether the image is right, and if not, where it first goes wrong.

`export(case, folder)` writes a case that a port in any language can read; the port writes its stages under the same names;
`check` answers PASS, FAIL or INCONCLUSIVE with the first wrong stage, a witness and what would explain it:

    case = oracle.build("displacement-box")            # or oracle.load_case(folder)
    submission = oracle.load_submission(folder, case)  # or oracle.submission_from_arrays(case, color=..., stages=...)
    examination = oracle.check(case, submission, profile="vulkan")
    print(examination.verdict.words())
    oracle.write_report(examination, "verdict.html")

Every stage is judged on the port's own arrays: `referees.reads` says for each array which. `undefined` lists what the APIs
leave undefined, and why no case depends on it.

What a correct port may do differently is stated by devices (`device.PROFILES`), each number with the clause that grants it.
From them `accept` derives bounds, and a referee for each method follows every decision whose margin is below its bound both
ways: so a port is never accused for a pixel that may legally fall on the other side, and never cleared for one that may not.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ibr_ref.oracle.answer import check
    from ibr_ref.oracle.cases import Case, build, names
    from ibr_ref.oracle.device import PROFILES, Device
    from ibr_ref.oracle.examination import Examination, examine
    from ibr_ref.oracle.files import Submission, export, load_case, load_submission, submission_from_arrays
    from ibr_ref.oracle.findings import Outcome
    from ibr_ref.oracle.report import write as write_report
    from ibr_ref.oracle.verdict import Verdict

_HOMES = {
    "PROFILES": "device",
    "Case": "cases",
    "Device": "device",
    "Examination": "examination",
    "Outcome": "findings",
    "Verdict": "verdict",
    "Submission": "files",
    "build": "cases",
    "check": "answer",
    "examine": "examination",
    "export": "files",
    "load_case": "files",
    "load_submission": "files",
    "names": "cases",
    "submission_from_arrays": "files",
}

__all__ = [
    "PROFILES",
    "Case",
    "Device",
    "Examination",
    "Outcome",
    "Submission",
    "Verdict",
    "build",
    "check",
    "examine",
    "export",
    "load_case",
    "load_submission",
    "names",
    "submission_from_arrays",
    "write_report",
]


def __getattr__(name: str) -> Any:
    """Import on first use: the pytest plugin lives here, and tests of other things must not wait for Numba."""
    if name == "write_report":
        return importlib.import_module("ibr_ref.oracle.report").write
    if name in _HOMES:
        return getattr(importlib.import_module(f"ibr_ref.oracle.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'ibr_ref.oracle' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*globals(), *__all__]
