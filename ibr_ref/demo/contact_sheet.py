"""A sheet of captioned pictures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_CAPTION_ROWS = 24
_GAP = 8


def _caption(text: str, width: int) -> NDArray[np.float64]:
    """A strip (rows, width, 3) with black text on white."""
    from PIL import Image, ImageDraw, ImageFont

    strip = Image.new("L", (width, _CAPTION_ROWS), 255)
    ImageDraw.Draw(strip).text((4, 4), text, fill=0, font=ImageFont.load_default(14))
    return np.repeat(np.asarray(strip, np.float64)[..., None] / 255.0, 3, axis=2)


def contact_sheet(pictures: list[tuple[str, NDArray[np.float64]]], columns: int) -> NDArray[np.float64]:
    """Pictures (H, W, 3) of one, even size, halved, row by row under their captions, on white."""
    height, width = pictures[0][1].shape[0] // 2, pictures[0][1].shape[1] // 2
    rows = -(-len(pictures) // columns)
    cell_height, cell_width = height + _CAPTION_ROWS + _GAP, width + _GAP
    sheet = np.ones((rows * cell_height + _GAP, columns * cell_width + _GAP, 3))
    for i, (caption, picture) in enumerate(pictures):
        top, left = _GAP + i // columns * cell_height, _GAP + i % columns * cell_width
        sheet[top : top + _CAPTION_ROWS, left : left + width] = _caption(caption, width)
        halved = picture.reshape(height, 2, width, 2, 3).mean(axis=(1, 3))
        sheet[top + _CAPTION_ROWS : top + _CAPTION_ROWS + height, left : left + width] = halved
    return sheet
