"""Its picture for `ibr-ref demo`."""

from __future__ import annotations

from ibr_ref.demo.picture import Picture, on_canvas
from tests.toy_method.case import ramp

SIZES, NOTE, PICTURES = "24 x 16", "nobody has measured it", 1


def pictures() -> list[Picture]:
    case = ramp("ramp-demo", 1.0)
    return [
        Picture(
            name="ramp",
            caption="a ramp",
            draw=lambda: on_canvas(case.draw(stages=False).color),
            frame=lambda: case.draw(stages=False),
        )
    ]
