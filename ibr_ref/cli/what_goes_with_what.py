"""Which options go with which: one table for all commands.

It says for every parameter of every command beside which others it is read; `command.Command` refuses it beside others.
Which method reads which field of its `Params` is said there, in `READ_BY`.
"""

from __future__ import annotations

from functools import cache
from typing import Any

GIVEN, ABSENT = object(), object()
"""In place of values: any, or none."""

Others = dict[str, Any]
"""Values of other parameters: each one, a tuple of those that will do, GIVEN or ABSENT."""


class Beside:
    """A parameter that is read only beside others: all of one of the alternatives."""

    def __init__(self, why: str, *alternatives: Others) -> None:
        self.why, self.alternatives = why, alternatives


ALWAYS = Beside("")


def _always(*names: str) -> dict[str, Beside]:
    return dict.fromkeys(names, ALWAYS)


@cache
def table() -> dict[str, dict[str, Beside]]:
    """By command and parameter."""
    return {
        "render displacement": _displacement(),
        "render splatting": _splatting(),
        "render shadows": _shadows(),
        "export": _export(),
        "check": _check(),
        "demo": _always("out"),
        "bench": {
            **_always("method", "repeat", "json"),
            "msr": Beside("photographs are splatted", {"method": ("all", "splatting")}),
        },
        "method": _always("name"),
        "reproduce": _always("paper", "out", "again"),
    }


def _displacement() -> dict[str, Beside]:
    from ibr_ref.displacement.inputs import READ_BY

    def read(field: str, **others: Any) -> Beside:
        return Beside(f"others do not read {field}", {"method": READ_BY[field], **others})

    walls = READ_BY["steep_threshold"]
    return {
        **_always("out", "height", "color", "invert_height", "height_scale", "eye", "target", "fov", "near", "far"),
        **_always("no_exif", "light", "size", "shadow_steps", "method", "stages"),
        "normal_height": Beside("it holds both", {"height": ABSENT, "normal": ABSENT}),
        "normal": Beside("--normal-height holds the normals", {"normal_height": ABSENT}),
        "facade": read("facade_map"),
        "facade_tile": Beside("facade_tile is the size of its tiles", {"facade": GIVEN}),
        "steps": read("linear_steps"),
        "binary_steps": Beside(
            "for others binary_steps only number the hits",
            {"method": READ_BY["binary_steps"]},
            {"method": "exact", "stages": GIVEN},
        ),
        "delta": Beside(
            "steep_threshold says what is covered by the facade",
            {"method": walls, "facade": GIVEN},
            {"method": walls, "stages": GIVEN},
        ),
        "interval": read("interval"),
        "faces": read("faces"),
        "lod_bias": read("lod_bias"),
        "min_steps": read("min_steps"),
        "max_steps": read("max_steps"),
        "distance_layers": read("distance_layers"),
    }


def _splatting() -> dict[str, Beside]:
    from ibr_ref.splatting.inputs import READ_BY

    one = "there is one source of references"
    photographs, camera = "it is about photographs", "the view is that of a camera of the data set"
    of_shape = {
        name: Beside(f"others do not read {name}", {"shape": READ_BY[name]})
        for name in ("min_width", "footprint", "low_pass", "cutoff", "depth_tolerance")
    }
    return {
        **_always("out", "near", "far", "max_width", "shape", "method", "light", "report", "stages"),
        **of_shape,
        "msr": Beside(one, {"simple_texture": ABSENT, "mesh": ABSENT}),
        "simple_texture": Beside(one, {"msr": ABSENT, "mesh": ABSENT}),
        "mesh": Beside(one, {"msr": ABSENT, "simple_texture": ABSENT}),
        **{name: Beside(photographs, {"msr": GIVEN}) for name in ("cameras", "view", "frame")},
        **{
            name: Beside("reference images are made of a mesh", {"mesh": GIVEN}) for name in ("count", "reference_size")
        },
        **{name: Beside(camera, {"msr": ABSENT}) for name in ("eye", "target", "up", "fov", "size")},
        "law": Beside("ellipses have no law, and a law is given or fitted", {"shape": READ_BY["alpha"], "fit": ABSENT}),
        "fit": Beside("ellipses have no law, and a law is given or fitted", {"shape": READ_BY["alpha"], "law": ABSENT}),
    }


def _shadows() -> dict[str, Beside]:
    from ibr_ref.shadows.inputs import METHODS, READ_BY
    from ibr_ref.shadows.soft import READ_BY as SOFT
    from ibr_ref.shadows.soft import SOFT_METHODS

    def warped(name: str) -> Beside:
        return Beside(f"others do not read {name}", {"method": READ_BY[name]})

    return {
        **_always("out", "caster", "offset", "method", "eye", "target", "near", "far", "size", "report", "stages"),
        "up": Beside("the built-in horse stands", {"caster": GIVEN}),
        "samples": Beside("others take the whole light", {"method": METHODS}),
        "light_size": Beside(
            "light_size is that of more than its centre", {"method": SOFT_METHODS}, {"samples": (5, 9)}
        ),
        "map_size": Beside("rays need no map_size", {"method": (*METHODS, *SOFT["map_size"])}),
        "map_samples": Beside(
            "map_samples count coverage", {"method": METHODS, "content": "mask"}, {"method": SOFT["map_samples"]}
        ),
        "content": Beside("others do not read content", {"method": METHODS}),
        "rows": warped("rows"),
        "columns": warped("columns"),
        "policy": warped("policy"),
        "interpolation": warped("interpolation"),
        "controls": Beside("no others have control points", {"method": "warp"}),
        "maps": Beside("no others are made beforehand", {"method": "warp"}),
    }


def _export() -> dict[str, Beside]:
    alone: Others = {"list_": ABSENT, "schema": ABSENT}
    return {
        **{name: Beside("nothing is written", alone) for name in ("case", "folder", "force")},
        "list_": Beside("one thing is printed", {"schema": ABSENT}),
        "schema": Beside("one thing is printed", {"list_": ABSENT}),
    }


def _check() -> dict[str, Beside]:
    alone: Others = {"self_test": ABSENT}
    return {
        **{name: Beside("--self-test takes no folders", alone) for name in ("case", "port")},
        **{name: Beside("--self-test prints its tables alone", alone) for name in ("device", "json", "report")},
        "self_test": ALWAYS,
        "method": Beside("--method goes with --self-test", {"self_test": GIVEN}),
    }
