"""What a stage is fed with when it is replayed: the port's own arrays, as they are, else the reference's with bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.accept.bounded import Bounded, exact, lerp, stored, uploaded
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed
from ibr_ref.oracle.referees.shadows import places
from ibr_ref.oracle.referees.shadows.maps import Map, rendered
from ibr_ref.oracle.referees.shadows.places import Place
from ibr_ref.oracle.referees.shadows.project import Coordinate, coordinate
from ibr_ref.oracle.referees.shadows.surface import Seen, see
from ibr_ref.oracle.referees.shadows.transform import Lens
from ibr_ref.oracle.referees.shadows.warp import Source, between, pair, place_of, warped

HANDED_OVER = ("maps.positions", "maps.image")
"""What the case hands over and a port may also make itself: with either it may go on, and for all of a stage with one."""


@dataclass(eq=False)
class Inputs:
    """A case on a device with what a port has handed in; each array is made when it is asked for, once."""

    case: Any
    device: Device
    handed: Handed = field(default_factory=dict)
    alone: Inputs | None = None
    """The same with nothing handed in: what does not depend on that is made there, once for all submissions."""

    @property
    def direct(self) -> bool:
        """Whether maps are rendered for every sample."""
        return bool(self.case.params.method == "direct")

    @property
    def count(self) -> int:
        """Light samples."""
        return places.count(self.case)

    @cached_property
    def samples(self) -> list[places.Sample]:
        """The light's samples."""
        return places.samples(self.case, self.device)

    @cached_property
    def centre_lens(self) -> Lens:
        """What the light's centre sees: the nine maps."""
        light = self.case.scene.light
        return Lens.of(light.camera(int(self.case.params.map_size)), np.abs(light.arrays[0]))

    @cached_property
    def lenses(self) -> list[Lens]:
        """What each sample sees."""
        size, light = int(self.case.params.map_size), self.case.scene.light
        return [Lens.of(light.camera(size, s.position), s.sizes) for s in self.samples]

    @cached_property
    def seen(self) -> Seen:
        """What the camera may see; no stage array holds it."""
        return see(self.case, self.device) if self.alone is None else self.alone.seen

    @cached_property
    def coordinates(self) -> list[Coordinate]:
        """Of what the camera may see, on the map of each sample."""
        if self.alone is not None:
            return self.alone.coordinates
        return [coordinate(lens, self.seen.world) for lens in self.lenses]

    def own(self, name: str, *, sampled: bool = True) -> Floats | None:
        """A port's array in float64, with an axis of samples first; None if it was not handed in."""
        if name not in self.handed:
            return None
        array = np.asarray(self.handed[name]).astype(np.float64)
        return array[None] if sampled and self.count == 1 else array

    def reference(self, name: str, *, sampled: bool = True) -> Floats:
        """The reference's, the same way."""
        array = np.asarray(self.case.frame.stages[name]).astype(np.float64)
        return array[None] if sampled and self.count == 1 else array

    def fed(self, name: str, *, sampled: bool = True) -> Floats | None:
        """A port's array as an input: None too where some of it is no number, for then its own stage is wrong."""
        array = self.own(name, sampled=sampled)
        return array if array is not None and np.isfinite(array).all() else None

    def spoiled(self, sample: int, names: Sequence[str]) -> bool:
        """Whether one of these arrays was handed in for a sample, and is of no use."""
        arrays = [self.own(name, sampled=name.startswith("warp.")) for name in names]
        parts = [a[sample] if n.startswith("warp.") else a for n, a in zip(names, arrays, strict=True) if a is not None]
        return not all(np.isfinite(part).all() for part in parts)

    @cached_property
    def as_the_case(self) -> Inputs | None:
        """The same with the nine maps that the case hands over in place of the port's own; None where it has none."""
        others = {name: array for name, array in self.handed.items() if name not in HANDED_OVER}
        return None if len(others) == len(self.handed) else Inputs(self.case, self.device, others, self.alone)

    @cached_property
    def lines(self) -> tuple[Bounded, Bounded]:
        """The three x and the three y of the nine maps: the port's own, or as they are given."""
        own = self.fed("maps.positions", sampled=False)
        if own is not None and (np.diff(own[0, :, 0]) > 0.0).all() and (np.diff(own[:, 0, 1]) > 0.0).all():
            positions = stored(own, self.device)
        else:
            positions = uploaded(self.reference("maps.positions", sampled=False), self.device)
        return positions[0, :, 0], positions[:, 0, 1]

    @cached_property
    def given_controls(self) -> Bounded:
        """(3, 3, R, C, 2) as they are given."""
        return uploaded(self.reference("controls", sampled=False), self.device)

    @cached_property
    def controls(self) -> Bounded:
        """(3, 3, R, C, 2): the port's own, or as they are given."""
        own = self.fed("controls", sampled=False)
        if own is not None:
            return stored(own, self.device, self.given_controls)
        return self.given_controls

    @cached_property
    def images(self) -> Bounded:
        """(3, 3, S, S): the port's own, or as they are given."""
        own = self.fed("maps.image", sampled=False)
        if own is not None:
            return stored(own, self.device)
        return uploaded(self.reference("maps.image", sampled=False), self.device)

    def offset_seen(self, sample: int) -> list[Bounded]:
        """x and y of the object as a sample sees it."""
        moves = self.samples[sample].displacement
        return [o - d for o, d in zip(places.offset(self.case, self.device), moves, strict=True)]

    def places(self, sample: int) -> list[tuple[Place, Place]]:
        """The cells and fractions along x and y that a sample may find, the likeliest first."""
        own_cell, own_fraction = self.own("warp.cell"), self.fed("warp.fraction")
        if own_cell is not None and not np.isin(own_cell[sample], (0.0, 1.0)).all():
            own_cell = None
        return place_of(
            self.lines,
            self.offset_seen(sample),
            None if own_cell is None else own_cell[sample].astype(np.int64),
            None if own_fraction is None else own_fraction[sample],
        )

    @property
    def projective(self) -> bool:
        """Whether maps are passed through at the pace of perspective."""
        return bool(not self.direct and self.case.params.interpolation == "projective")

    @cached_property
    def depths(self) -> Bounded:
        """(3, 3) of the caster in the nine maps: the port's own, or made at the maps' lines."""
        own = self.fed("maps.depths", sampled=False)
        return self.made_depths if own is None else stored(own, self.device)

    @cached_property
    def made_depths(self) -> Bounded:
        """At the maps' lines."""
        return places.depths(self.case, self.centre_lens, self.lines)

    def shares(self, sample: int, place: tuple[Place, Place]) -> list[Bounded]:
        """Of the next map in the upper row and in the lower one, and of the lower row."""
        own = self.fed("warp.shares") if self.projective else None
        return self.made_shares(place) if own is None else [stored(n, self.device) for n in own[sample]]

    def made_shares(self, place: tuple[Place, Place]) -> list[Bounded]:
        """From the fractions, and the depths if they matter."""
        x, y = place
        if not self.projective:
            return [x.fraction, x.fraction, y.fraction]
        corners = [[self.depths[y.cell + k, x.cell + n] for n in range(2)] for k in range(2)]
        ends = [lerp(row[0], row[1], x.fraction) for row in corners]
        return [
            places.paced(x.fraction, *corners[0]),
            places.paced(x.fraction, *corners[1]),
            places.paced(y.fraction, *ends),
        ]

    def row_grids(self, sample: int, place: tuple[Place, Place]) -> list[Bounded]:
        """Two (R, C, 2)."""
        own = self.fed("warp.row_grids")
        if own is not None:
            return [stored(grid, self.device) for grid in own[sample]]
        return self.made_row_grids(sample, place)

    def made_row_grids(self, sample: int, place: tuple[Place, Place]) -> list[Bounded]:
        """From the controls."""
        x, y = place
        return [
            between(self.controls[y.cell + k, x.cell], self.controls[y.cell + k, x.cell + 1], share)
            for k, share in enumerate(self.shares(sample, place)[:2])
        ]

    def grid(self, sample: int, place: tuple[Place, Place]) -> Bounded:
        """(R, C, 2)."""
        own = self.fed("warp.grid")
        if own is not None:
            return stored(own[sample], self.device)
        return self.made_grid(sample, place)

    def made_grid(self, sample: int, place: tuple[Place, Place]) -> Bounded:
        """From the row grids."""
        first, second = self.row_grids(sample, place)
        return between(first, second, self.shares(sample, place)[2])

    def rows(self, sample: int, place: tuple[Place, Place]) -> list[Bounded]:
        """Two (S, S)."""
        own = self.fed("warp.rows")
        if own is not None:
            return [stored(row, self.device) for row in own[sample]]
        return self.made_rows(sample, place)

    def made_rows(self, sample: int, place: tuple[Place, Place]) -> list[Bounded]:
        """From the nine maps."""
        targets, shares = self.row_grids(sample, place), self.shares(sample, place)
        return [
            pair(self.sources(place, k), shares[k], target, self.nearest, self.nothing)
            for k, target in enumerate(targets)
        ]

    def sources(self, place: tuple[Place, Place], row: int) -> list[Source]:
        """The two maps of a row."""
        x, y = place
        return [Source(self.images[y.cell + row, x.cell + n], self.controls[y.cell + row, x.cell + n]) for n in (0, 1)]

    @property
    def nearest(self) -> bool:
        """The policy of three warps."""
        return bool(self.case.params.policy == "nearest")

    @property
    def nothing(self) -> float:
        """A texel without anything."""
        return 1.0 if self.case.params.content == "depth" else 0.0

    def made_image(self, sample: int, place: tuple[Place, Place]) -> Bounded:
        """(S, S) from the rows."""
        grids, rows = self.row_grids(sample, place), self.rows(sample, place)
        sources = [Source(row, grid) for row, grid in zip(rows, grids, strict=True)]
        return pair(sources, self.shares(sample, place)[2], self.grid(sample, place), self.nearest, self.nothing)

    def map(self, sample: int) -> Map:
        """What is projected for a sample."""
        own = self.own("warp.image")
        if own is not None:
            bad = ~np.isfinite(own[sample])
            texels = np.where(bad, self.reference("warp.image")[sample], own[sample])
            # A map that is rendered was cleared to 1; a warped one holds mixes, rounded to 1 or not.
            return Map.of(stored(texels, self.device, exact(1.0, self.device) if self.direct else None), bad)
        if self.direct:
            at = places.offset(self.case, self.device)
            return rendered(self.case, self.lenses[sample], at, self.reference("warp.image")[sample])
        return Map.of(warped([self.made_image(sample, place) for place in self.places(sample)]))
