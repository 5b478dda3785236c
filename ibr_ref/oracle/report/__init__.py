"""A verdict as one HTML page that needs nothing else: pictures, numbers and scripts are inside."""

from ibr_ref.oracle.report.page import page, write

__all__ = ["page", "write"]
