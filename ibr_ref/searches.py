"""The searches of displacement mapping, `Params.method`: one line each, the only list of them.

The first four are built into the fragment kernel (`displacement.fragment.BUILT_IN`), one behind the other. Each of the
others is a system to compare with, and has a file of its own: `search(sought)` there finds the hits of all pixels, and is
imported when it is first asked for. What the methods, the command line and its help say of a search follows from its line.
"""

from __future__ import annotations

from dataclasses import dataclass

from ibr_ref.methods import Room


@dataclass(frozen=True)
class Search:
    """A way to find where a view ray hits."""

    name: str
    reads: tuple[str, ...]
    """Fields of `Params`, and of the polygon "facade_map", on which its picture and its hits depend, of those that not all
    searches read."""
    sinks: bool = False
    """The polygon is the top of the volume: what is not raised sinks below it."""
    room: Room | None = None
    """Its file, of a system to compare with."""

    @property
    def displaces(self) -> bool:
        """Whether depth is that of a hit off the polygon: else it is always the polygon's."""
        return "depth" in self.reads


def _compared(name: str, *reads: str, sinks: bool = True) -> Search:
    return Search(name, reads, sinks, Room(f"ibr_ref.displacement.{name}"))


_OF_FACES = ("steep_threshold", "facade_map", "interval", "faces")

# fmt: off
SEARCHES: dict[str, Search] = {search.name: search for search in (
    Search("protruded", ("linear_steps", "binary_steps", *_OF_FACES, "depth")),
    Search("exact", ("linear_steps", *_OF_FACES, "depth")),
    Search("relief", ("linear_steps", "binary_steps", "depth"), sinks=True),
    Search("texture", ("depth",)),
    _compared("welsh", sinks=False),
    _compared("mcguire", "linear_steps", "depth", "lod_bias"),
    _compared("donnelly", "linear_steps", "depth", "distance_layers"),
    _compared("tatarchuk", "depth", "min_steps", "max_steps"),
    _compared("cone", "linear_steps", "depth"),
    _compared("relaxed_cone", "linear_steps", "binary_steps", "depth"),
    _compared("maximum_mipmap", "depth"),
)}
# fmt: on
"""In the order in which they are listed."""


def read_by() -> dict[str, tuple[str, ...]]:
    """For each field that only some searches read: which."""
    fields = dict.fromkeys(field for search in SEARCHES.values() for field in search.reads)
    return {field: tuple(s.name for s in SEARCHES.values() if field in s.reads) for field in fields}
