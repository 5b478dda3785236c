"""A verdict as one HTML page that needs nothing else: pictures, numbers and scripts are inside; many as JUnit XML."""

from ibr_ref.oracle.report.junit import junit
from ibr_ref.oracle.report.page import page, write

__all__ = ["junit", "page", "write"]
