"""The computation of one element of a stage, reference and port side by side."""

from ibr_ref.oracle.referees.shadows.trace.elements import trace

__all__ = ["trace"]
