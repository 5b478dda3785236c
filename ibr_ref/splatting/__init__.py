"""Splatting of depth images (Lee & Park 2006)."""

from ibr_ref.splatting.coverage import Coverage
from ibr_ref.splatting.inputs import Params, Scene
from ibr_ref.splatting.measures import coverage, fit_splat_law
from ibr_ref.splatting.render import render
from ibr_ref.splatting.size_law import SplatLaw

__all__ = ["Coverage", "Params", "Scene", "SplatLaw", "coverage", "fit_splat_law", "render"]
