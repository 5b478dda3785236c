"""What numbers of a depth set mean, where a format or its user has to say it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ibr_ref.choices import CAMERA_AXES, DEPTHS_ALONG, PIXEL_CENTERS, POSES
from ibr_ref.scene import checks

if TYPE_CHECKING:
    from ibr_ref.io.depth_sets.view import View

CHOICES = {
    "convention": CAMERA_AXES,
    "poses": POSES,
    "along": DEPTHS_ALONG,
    "pixel_centers": PIXEL_CENTERS,
}
"""The values of options that are words."""


class Options(NamedTuple):
    """What a caller says of a set; None: what the format, or the set itself, says. `read_depth_set` has the meanings."""

    convention: str | None = None
    poses: str | None = None
    along: str | None = None
    pixel_centers: str | None = None
    depth_scale: float | None = None
    intrinsics: Sequence[float] | None = None
    max_time_gap: float | None = None


class Conventions(NamedTuple):
    """What a format says of itself; None: it leaves that open."""

    convention: str | None
    poses: str | None
    along: str | None
    pixel_centers: str | None
    depth_scale: float | None = None
    """Of whole numbers; floats are world units."""


class Format(NamedTuple):
    """A kind of depth set."""

    name: str
    wants: str
    """The files that it is known by, in words."""
    holds: Callable[[Path], bool]
    """Whether a folder has them."""
    views: Callable[[Path, Options], list[View]]
    """What it says of each picture. Raises OSError and ValueError."""
    says: Conventions
    reads: tuple[str, ...]
    """Fields of `Options` that it has a use for."""


ANY = ("convention", "poses", "along", "pixel_centers", "depth_scale")


def checked(options: Options) -> Options:
    """The options, those that are given being what they may be."""
    for name, allowed in CHOICES.items():
        if getattr(options, name) is not None:
            checks.choice(name, getattr(options, name), allowed)
    scale, intrinsics, difference = options.depth_scale, options.intrinsics, options.max_time_gap
    return options._replace(
        depth_scale=None if scale is None else checks.number("depth_scale", scale, above=0.0, high=1e9),
        intrinsics=None if intrinsics is None else checks.vector("intrinsics", intrinsics, 4).tolist(),
        max_time_gap=None if difference is None else checks.number("max_time_gap", difference, low=0.0, high=1e9),
    )


def settled(format_: Format, options: Options) -> Conventions:
    """What holds for a set: the caller's word before the format's.

    Raises ValueError for an option that the format has no use for, and for one that it leaves open and nobody gave.
    """
    for name, value in options._asdict().items():
        if value is not None and name not in format_.reads:
            allowed = f"None with the format {format_.name}, which says it or has none"
            raise checks.reject(name, value, allowed)
    result = {}
    for name in Conventions._fields:
        given = getattr(options, name)
        result[name] = getattr(format_.says, name) if given is None else given
    open_ = [name for name in CHOICES if result[name] is None]
    if open_:
        allowed = "; ".join(f"{name} {' | '.join(CHOICES[name])}" for name in open_)
        raise ValueError(
            f"{', '.join(open_)}: found None, which the format {format_.name} leaves open, allowed: {allowed}"
        )
    return Conventions(**result)
