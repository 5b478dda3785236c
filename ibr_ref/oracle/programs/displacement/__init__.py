"""Displacement mapping: its program, and those of the searches that people port besides."""

from ibr_ref.oracle.programs.displacement import searches
from ibr_ref.oracle.programs.displacement.port import PROGRAMS, Port

__all__ = ["PROGRAMS", "Port", "searches"]
