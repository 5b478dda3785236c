"""Protruded displacement mapping (Yoo & Han 2006)."""

from ibr_ref.displacement.inputs import Params, Scene
from ibr_ref.displacement.render import render

__all__ = ["Params", "Scene", "render"]
