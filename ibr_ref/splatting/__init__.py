"""Splatting of depth images (Lee & Park 2006)."""

from ibr_ref.splatting.inputs import Params, Scene
from ibr_ref.splatting.render import render

__all__ = ["Params", "Scene", "render"]
