"""The demo's pictures of shadows: figures 3, 6 to 8 and 9 to 12 of Kang & Ihm 2002, on our own kettle and horse."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

from ibr_ref.demo.picture import SIZE, Picture, on_canvas

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ibr_ref.shadows import Maps, Params, Scene

SIZES = "640 x 480, maps of 512 x 512"
NOTE = "paper: table 1 for whole frames, table 5 for nine samples; `ibr-ref bench` measures with more care"
PICTURES = 8

OFFSET = (0.23, -0.31)
"""Between the nine places that maps are made for."""


def pictures() -> list[Picture]:
    """Projected map (3), maps and control points (6), warped and rendered (7), accumulated (8), hard and soft (9-12)."""
    return [
        Picture("shadow_figure_3", "3 the map projected onto the receivers", lambda: _grey("project.shadow", 1)),
        Picture("shadow_figure_6", "6 nine maps and their control points", _nine_maps),
        Picture("shadow_figure_7", "7 warped, rendered, and where they differ", _warped_and_rendered),
        Picture("shadow_figure_8", "8 nine samples, accumulated", lambda: _grey("accumulate.shadow", 9)),
        _frame("shadow_figure_9", "9 hard shadow of the kettle", "kettle", 1, "55"),
        _frame("shadow_figure_10", "10 soft shadow of the kettle", "kettle", 9, "142"),
        _frame("shadow_figure_11", "11 hard shadow of the horse", "horse", 1, "68"),
        _frame("shadow_figure_12", "12 soft shadow of the horse", "horse", 9, ""),
    ]


@cache
def _stage(name: str, samples: int) -> tuple[Scene, Params, Maps]:
    from ibr_ref import models, shadows

    scene = models.shadow_stage(getattr(models, name)(), offset=OFFSET, **SIZE)
    params = shadows.Params(light_samples=samples)
    return scene, params, shadows.prepare(scene, params)


def _frame(name: str, caption: str, caster: str, samples: int, paper_ms: str) -> Picture:
    from ibr_ref import shadows

    def frame() -> Any:
        scene, params, maps = _stage(caster, samples)
        return shadows.render(scene, params, maps=maps, stages=False)

    settings = f"15 x 5 control points, {samples} sample{'s' if samples > 1 else ''}"
    return Picture(name, caption, lambda: frame().color, frame, settings, paper_ms)


def _grey(stage: str, samples: int) -> Any:
    """A stage array of the horse's frame in greys, white where light comes."""
    import numpy as np

    from ibr_ref import shadows

    scene, params, maps = _stage("horse", samples)
    lit = 1.0 - shadows.render(scene, params, maps=maps).stages[stage]
    return np.clip(lit, 0.0, 1.0)[..., None].repeat(3, axis=2)


def _nine_maps() -> Any:
    """The maps, the caster dark, with their grids in red."""
    import numpy as np

    _, _, maps = _stage("horse", 1)
    cells = []
    for j in range(3):
        line = []
        for i in range(3):
            image = 0.95 - 0.7 * maps.image[j, i].reshape(128, 4, 128, 4).mean(axis=(1, 3))
            cell = np.pad(image[..., None].repeat(3, axis=2), ((2, 2), (2, 2), (0, 0)), constant_values=1.0)
            _draw_grid(cell[2:-2, 2:-2], maps.controls[j, i])
            line.append(cell)
        cells.append(np.concatenate(line, axis=1))
    return on_canvas(np.concatenate(cells))


def _draw_grid(image: Any, points: Any) -> None:
    """The lines between neighbouring control points, in red."""
    import numpy as np

    size = len(image)
    steps = np.linspace(0.0, 1.0, 2 * size)[:, None]
    for a, b in ((points[:-1], points[1:]), (points[:, :-1], points[:, 1:])):
        for start, end in zip(a.reshape(-1, 2), b.reshape(-1, 2), strict=True):
            x, y = np.clip((start + (end - start) * steps) * size, 0, size - 1).astype(int).T
            image[y, x] = (0.85, 0.2, 0.15)


def _warped_and_rendered() -> Any:
    return on_canvas(warped_and_rendered(*_stage("horse", 1)))


def warped_and_rendered(scene: Scene, params: Params, maps: Maps) -> NDArray[np.float64]:
    """(474, 400, 3) of one light sample's map: warped, rendered, and where they differ, around the shadow.

    The difference is red where only the warped map is dark, blue where only the rendered one is. Maps of 400 or more.
    """
    import numpy as np

    from ibr_ref import shadows

    warped = shadows.shadow_maps(scene, params, maps=maps)[0]
    rendered = shadows.shadow_maps(scene, replace(params, method="direct"))[0]
    where = np.argwhere((warped > 0) | (rendered > 0))
    size = len(warped)
    top, left = np.clip(where.mean(axis=0).astype(int) - (75, 200), 0, (size - 150, size - 400))
    window = np.s_[top : top + 150, left : left + 400]
    a, b = warped[window], rendered[window]
    greys = [1.0 - 0.85 * m[..., None].repeat(3, axis=2) for m in (a, b)]
    gap = np.full((12, 400, 3), 0.9)
    return np.concatenate([greys[0], gap, greys[1], gap, difference(a, b)])


def difference(ours: NDArray[np.float64], theirs: NDArray[np.float64]) -> NDArray[np.float64]:
    """(H, W, 3) two shadows on white: dark where both are, red where ours alone is, blue where theirs alone is."""
    import numpy as np

    both = np.minimum(ours, theirs)
    red, blue = ours - both, theirs - both
    return np.clip(np.stack([1.0 - both - 0.9 * blue, 1.0 - both - red - blue, 1.0 - both - 0.9 * red], axis=2), 0, 1)
