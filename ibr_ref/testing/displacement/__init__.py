"""Strategies for protruded displacement mapping."""

from ibr_ref.testing.displacement.scenes import Drawn, drawn, small
from ibr_ref.testing.displacement.views import REGIONS

__all__ = ["REGIONS", "Drawn", "drawn", "small"]
