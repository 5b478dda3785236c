"""One picture of the demo."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

WIDTH, HEIGHT = 640, 480
SIZE = {"width": WIDTH, "height": HEIGHT}


@dataclass(frozen=True)
class Picture:
    """A figure of a paper, from built-in inputs."""

    name: str
    """File name without ending."""
    caption: str
    draw: Callable[[], NDArray[np.float64]]
    """Makes it, (480, 640, 3)."""
    frame: Callable[[], object] | None = None
    """Renders the frame that it shows, without stages: what is timed. None: the picture is no frame."""
    settings: str = ""
    """What the frame is rendered with, for the table."""
    paper_ms: str = ""
    """The paper's time."""


def on_canvas(image: NDArray[np.float64]) -> NDArray[np.float64]:
    """An image (H, W, 3) of at most 640 x 480 pixels in the middle of a white picture of that size."""
    import numpy as np

    canvas = np.ones((HEIGHT, WIDTH, 3))
    height, width = image.shape[:2]
    top, left = (HEIGHT - height) // 2, (WIDTH - width) // 2
    canvas[top : top + height, left : left + width] = image
    return canvas
