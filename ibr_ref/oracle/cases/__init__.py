"""The built-in cases: at least four a method, easy, typical, adversarial and real-sized."""

from ibr_ref.oracle.cases.case import Case

__all__ = ["Case"]
