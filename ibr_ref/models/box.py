"""The paper's figure 6: one blue box on a yellow ground with a grid."""

import numpy as np
from numpy.typing import NDArray

from ibr_ref.models.facades import brick_facade
from ibr_ref.models.heights import HEIGHT_STEPS, clear_of_lattice
from ibr_ref.scene import BasePolygon

HEIGHT_TEXELS = 256
COLOR_TEXELS = 512
BOX_BEGIN, BOX_END = 80, 176
"""The box in texels of the height map: 3/8 of the polygon's width, its corners on whole facade tiles."""

GRID_PITCH = 64
YELLOW = np.array((236, 208, 84))
GRID = np.array((74, 60, 26))
BLUE = np.array((52, 92, 196))
BLUE_GRID = np.array((92, 132, 226))
OUTLINE = np.array((0, 0, 0))


def box() -> BasePolygon:
    """A box on the ground, 1 × 1 world units around the origin, z up; height 256 × 256, colour 512 × 512 texels.

    The box is 0.375 wide and 0.186 high. The black outline of its footprint in the colour map lies just where the walls
    are: without the facade map it smears over them (figure 6e), with it the walls are brick (figure 6f).
    """
    return BasePolygon(
        corner=(-0.5, -0.5, 0.0),
        edge_u=(1.0, 0.0, 0.0),
        edge_v=(0.0, 1.0, 0.0),
        height_map=_height_map(),
        color_map=_color_map(),
        height_scale=0.2,
        facade_map=brick_facade(),
        facade_tile=(0.0625, 0.0625),
    )


def _height_map() -> NDArray[np.float64]:
    """Heights (256, 256): 0 on the ground, about 0.93 on the box."""
    heights = np.zeros((HEIGHT_TEXELS, HEIGHT_TEXELS), dtype=np.int64)
    heights[BOX_BEGIN:BOX_END, BOX_BEGIN:BOX_END] = 60948
    return clear_of_lattice(heights) / HEIGHT_STEPS


def _color_map() -> NDArray[np.float64]:
    """Colours (512, 512, 3): a grid on yellow, a lighter one on blue, a black outline two texels wide between them."""
    in_cell = np.arange(COLOR_TEXELS) % GRID_PITCH
    on_line = (in_cell < 2) | (in_cell >= GRID_PITCH - 2)
    grid = (on_line[:, np.newaxis] | on_line)[..., np.newaxis]
    scale = COLOR_TEXELS // HEIGHT_TEXELS
    begin, end = BOX_BEGIN * scale, BOX_END * scale
    inside = slice(begin + 1, end - 1)
    colors = np.where(grid, GRID, YELLOW)
    colors[begin - 1 : end + 1, begin - 1 : end + 1] = OUTLINE
    colors[inside, inside] = np.where(grid, BLUE_GRID, BLUE)[inside, inside]
    return colors / 255
