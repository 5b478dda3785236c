"""A verdict as one HTML page that needs nothing else: pictures, numbers and scripts are inside; many as JUnit XML."""

from ibr_ref.oracle.report.junit import junit
from ibr_ref.oracle.report.page import page, write
from ibr_ref.oracle.report.run import Entry, Facts, entry, run_page, write_run

__all__ = ["Entry", "Facts", "entry", "junit", "page", "run_page", "write", "write_run"]
