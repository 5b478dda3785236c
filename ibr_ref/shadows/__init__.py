"""Shadows by image warping (Kang & Ihm 2002): the map for an object's place, warped from nine that were made beforehand."""

from ibr_ref.scene import AreaLight
from ibr_ref.shadows.grid import MapGrid, prepare_grid
from ibr_ref.shadows.inputs import Params, Scene
from ibr_ref.shadows.prepare import Maps, prepare
from ibr_ref.shadows.render import render

__all__ = ["AreaLight", "MapGrid", "Maps", "Params", "Scene", "prepare", "prepare_grid", "render"]
