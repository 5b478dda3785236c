"""Cases as folders, and what ports hand in: everything of the oracle that touches a file."""

from ibr_ref.oracle.files.changed import changed_stages, outdated
from ibr_ref.oracle.files.content import empty, stale
from ibr_ref.oracle.files.load import load_case
from ibr_ref.oracle.files.problem import Problem
from ibr_ref.oracle.files.submission import Submission, load_submission, submission_from_arrays
from ibr_ref.oracle.files.write import check_replaceable, export

__all__ = [
    "Problem",
    "Submission",
    "changed_stages",
    "check_replaceable",
    "empty",
    "export",
    "load_case",
    "load_submission",
    "outdated",
    "stale",
    "submission_from_arrays",
]
