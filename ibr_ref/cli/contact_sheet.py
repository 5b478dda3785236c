"""A sheet of captioned pictures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_CAPTION_ROWS = 28
_GAP = 8


def _caption(text: str, width: int) -> NDArray[np.float64]:
    """A strip (rows, width, 3) with black text on white."""
    from PIL import Image, ImageDraw, ImageFont

    strip = Image.new("L", (width, _CAPTION_ROWS), 255)
    ImageDraw.Draw(strip).text((4, 4), text, fill=0, font=ImageFont.load_default(16))
    return np.repeat(np.asarray(strip, np.float64)[..., None] / 255.0, 3, axis=2)


def contact_sheet(pictures: list[tuple[str, NDArray[np.float64]]], columns: int) -> NDArray[np.float64]:
    """Pictures (H, W, 3) of one size, row by row under their captions, on white."""
    height, width = pictures[0][1].shape[:2]
    rows = -(-len(pictures) // columns)
    cell_height, cell_width = height + _CAPTION_ROWS + _GAP, width + _GAP
    sheet = np.ones((rows * cell_height + _GAP, columns * cell_width + _GAP, 3))
    for i, (caption, picture) in enumerate(pictures):
        top, left = _GAP + i // columns * cell_height, _GAP + i % columns * cell_width
        sheet[top : top + _CAPTION_ROWS, left : left + width] = _caption(caption, width)
        sheet[top + _CAPTION_ROWS : top + _CAPTION_ROWS + height, left : left + width] = picture
    return sheet
