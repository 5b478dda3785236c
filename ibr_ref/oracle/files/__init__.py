"""Cases as folders, and what ports hand in: everything of the oracle that touches a file."""

from ibr_ref.oracle.files.export import export
from ibr_ref.oracle.files.load import changed_stages, load_case
from ibr_ref.oracle.files.problem import Problem

__all__ = ["Problem", "changed_stages", "export", "load_case"]
