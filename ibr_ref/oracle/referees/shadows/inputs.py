"""What a stage is fed with when it is replayed: the port's own arrays, as they are, else the reference's with bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.accept.bounded import exact, stored
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed
from ibr_ref.oracle.programs.shadows.grid import Grid
from ibr_ref.oracle.programs.shadows.lights import Lights
from ibr_ref.oracle.programs.shadows.maps import Maps
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.soft import SOFT
from ibr_ref.oracle.programs.shadows.surface import Picture
from ibr_ref.oracle.programs.shadows.warp import Warp
from ibr_ref.oracle.referees.outcomes import stored as stored_number
from ibr_ref.oracle.referees.shadows import places
from ibr_ref.oracle.referees.shadows.device import model_of
from ibr_ref.oracle.referees.shadows.maps import Map, rendered
from ibr_ref.oracle.referees.shadows.model import Model
from ibr_ref.oracle.referees.shadows.places import Place
from ibr_ref.oracle.referees.shadows.project import Coordinate, coordinate
from ibr_ref.oracle.referees.shadows.surface import Seen, see

HANDED_OVER = ("maps.positions", "maps.image")
"""What the case hands over and a port may also make itself: with either it may go on, and for all of a stage with one."""
SEEN = {*vars(Picture), "surface_raster", "caster_vertices", "clip_coordinates", "applied", "by_product", "product"}
SEEN |= {"light_centre", "cosine", "toward_eye", "toward_light", "turned", "lambert"}
"""What of a program says what the camera sees, and in which light."""
MAPPED = {*vars(Maps), *vars(Warp), *vars(Grid), *vars(Lights), "soft_map", "soft_clip"} - {
    "shadow_sampler",
    "surface_raster",
    "on",
}
"""What of a program says what is projected."""
RENDERED = ("direct_map", "soft_map", "caster_map", "coverage", "share", "depths")
"""What makes a map that is rendered alone of what is drawn."""
DRAWN = {*vars(Maps), *vars(Lights), "map_raster", "intervals", "grid_ends", "grid_position"}
"""What says what the maps of a grid are, whatever is made of them."""
Spot = tuple[Place, Place]
"""Along x and along y."""


@dataclass(eq=False)
class Inputs:
    """A case on a device with what a port has handed in; each array is made when it is asked for, once."""

    case: Any
    device: Device
    handed: Handed = field(default_factory=dict)
    alone: Inputs | None = None
    """The same with nothing handed in: what does not depend on that is made there, once for all submissions."""
    kind: type[Port] = Port
    """The program: the right one, or one with a known bug."""
    among: Bools | None = None
    """(H W,) the pixels of the picture that are looked at; None: all."""
    right: Inputs | None = None
    """By the right program: a program with a bug shares what that does not change."""
    thorough: bool = False
    """Also of a program that is contradicted already the rest is looked at."""
    picture: Handed = field(default_factory=dict)
    """What is compared in the end, of a picture that is judged by itself."""

    @cached_property
    def model(self) -> Model:
        """The program on the device."""
        if self.alone is not None and self.alone.kind is self.kind:
            return self.alone.model
        return model_of(self.case, self.device, self.kind)

    def refuted(self, right: Bools) -> bool:
        """Whether a known bug is contradicted already, and need not be looked at any further."""
        if self.right is None or self.thorough:
            return False
        return not right.all() if self.among is None or right.size != self.among.size else not right[self.among].all()

    @property
    def direct(self) -> bool:
        """Whether a map is rendered alone for every sample, or for the whole light."""
        return bool(self.case.params.method in ("direct", SOFT))

    @property
    def warps(self) -> bool:
        """Whether they are warped from nine."""
        return bool(self.case.params.method == "warp")

    @property
    def count(self) -> int:
        """Light samples."""
        given = self.model.program.params.light_samples
        return len(given) if isinstance(given, np.ndarray) else int(given)

    @cached_property
    def seen(self) -> Seen:
        """What the camera may see; no stage array holds it."""
        if self.alone is None or (self.kind is not self.alone.kind and self.model.changes(SEEN)):
            found = see(self.model)
        else:
            found = self.alone.seen
        return found if self.among is None else found.among(self.among)

    def coordinate(self, sample: int) -> Coordinate:
        """Of what the camera may see, on the map of a sample."""
        if sample not in self._coordinates:
            shared = self.alone is not None and self.alone.kind is self.kind and self.among is None
            found = self.alone.coordinate(sample) if shared and self.alone else None
            self._coordinates[sample] = found or coordinate(self.model, sample, self.seen.world)
        return self._coordinates[sample]

    @cached_property
    def _coordinates(self) -> dict[int, Coordinate]:
        return {}

    @cached_property
    def exact_arrays(self) -> dict[str, Any]:
        """What the program makes of the case in exact arithmetic."""
        if self.kind is Port:
            return dict(self.case.frame.stages)
        with np.errstate(all="ignore"):
            return dict(self.model.exact.render())

    def own(self, name: str, *, sampled: bool = True) -> Floats | None:
        """A port's array in float64, with an axis of samples first; None if it was not handed in."""
        if name not in self.handed:
            return None
        array = np.asarray(self.handed[name]).astype(np.float64)
        return array[None] if sampled and self.count == 1 else array

    def reference(self, name: str, *, sampled: bool = True) -> Floats:
        """The program's in exact arithmetic, the same way."""
        array = np.asarray(self.exact_arrays[name]).astype(np.float64)
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
        if len(others) == len(self.handed):
            return None
        right = None if self.right is None else self.right.as_the_case
        return replace(self, handed=others, right=right)

    def _stored(self, own: Floats, legal: Any = None) -> Number:
        return stored_number(self.model.machine, own, legal)

    @cached_property
    def lines(self) -> list[Number]:
        """The three x and the three y of the nine maps: the port's own, or as they are given."""
        own = self.fed("maps.positions", sampled=False)
        if own is not None and (np.diff(own[0, :, 0]) > 0.0).all() and (np.diff(own[:, 0, 1]) > 0.0).all():
            positions = self._stored(own)
            return [positions[0, :, 0], positions[:, 0, 1]]
        return list(self.model.program.lines())

    @cached_property
    def given_controls(self) -> Number:
        """(3, 3, R, C, 2) as they are given."""
        return self.model.machine.of(self.model.program.controls())

    @cached_property
    def controls(self) -> Number:
        """(3, 3, R, C, 2): the port's own, or as they are given."""
        own = self.fed("controls", sampled=False)
        return self.given_controls if own is None else self._stored(own, self.given_controls)

    @cached_property
    def images(self) -> Number:
        """(3, 3, S, S): the port's own, or as they are given."""
        own = self.fed("maps.image", sampled=False)
        return self.model.machine.of(self.model.program.images()) if own is None else self._stored(own)

    @cached_property
    def displacements(self) -> list[Number]:
        """(2,) of each sample from the light's centre, along the axes."""
        return [self.model.program.displacement(place) for place in self.model.program.places]

    def offset_seen(self, sample: int) -> Number:
        """(2,) of the object as a sample sees it."""
        program = self.model.program
        return self.model.machine.of(program.place_of_object(program.places[sample]))

    def places(self, sample: int) -> list[Spot]:
        """The cells and fractions along x and y that a sample may find, the likeliest first."""
        cell, fraction = self.own("warp.cell"), self.fed("warp.fraction")
        if cell is not None and not np.isin(cell[sample], (0.0, 1.0)).all():
            cell = None
        axes: list[list[Place]] = []
        for k, (line, at) in enumerate(zip(self.lines, self.offset_seen(sample), strict=True)):
            if cell is None:
                found = places.located(self.model, line, at)
            else:
                own = int(cell[sample, k])
                found = [Place(own, places.fraction_in(self.model, line, at, own))]
            if fraction is not None:
                found = [Place(p.cell, stored(fraction[sample, k], self.device, p.fraction)) for p in found]
            axes.append(found)
        return [(x, y) for x in axes[0] for y in axes[1]]

    @property
    def projective(self) -> bool:
        """Whether maps are passed through at the pace of perspective."""
        return bool(self.warps and self.case.params.interpolation == "projective")

    @cached_property
    def depths(self) -> Number:
        """(3, 3) of the caster in the nine maps: the port's own, or made at the maps' lines."""
        own = self.fed("maps.depths", sampled=False)
        return self.made_depths if own is None else self._stored(own)

    @cached_property
    def made_depths(self) -> Number:
        """At the maps' lines."""
        return self.model.machine.of(self.model.program.caster_depths(self.lines))

    def _cell(self, spot: Spot) -> Any:
        return np.array([place.cell for place in spot], np.int32)

    def shares(self, sample: int, spot: Spot) -> list[Number]:
        """Of the next map in the upper row and in the lower one, and of the lower row."""
        own = self.fed("warp.shares") if self.projective else None
        return self.made_shares(spot) if own is None else [self._stored(n) for n in own[sample]]

    def made_shares(self, spot: Spot) -> list[Number]:
        """From the fractions, and the depths if they matter."""
        fraction = [self.model.number(place.fraction) for place in spot]
        return list(self.model.program.shares(self._cell(spot), fraction, self.depths if self.projective else None))

    def grids(self, spot: Spot) -> list[Number]:
        """Four (R, C, 2) of the cell's maps."""
        return list(self.model.program.corners(self.controls, self._cell(spot)))

    def maps(self, spot: Spot) -> list[Number]:
        """Four (S, S)."""
        return list(self.model.program.corners(self.images, self._cell(spot)))

    def row_grids(self, sample: int, spot: Spot) -> list[Number]:
        """Two (R, C, 2)."""
        own = self.fed("warp.row_grids")
        return self.made_row_grids(sample, spot) if own is None else [self._stored(grid) for grid in own[sample]]

    def made_row_grids(self, sample: int, spot: Spot) -> list[Number]:
        """From the controls."""
        return list(self.model.program.row_grids(self.grids(spot), self.shares(sample, spot)))

    def grid(self, sample: int, spot: Spot) -> Number:
        """(R, C, 2)."""
        own = self.fed("warp.grid")
        return self.made_grid(sample, spot) if own is None else self._stored(own[sample])

    def made_grid(self, sample: int, spot: Spot) -> Number:
        """From the row grids."""
        first, second = self.row_grids(sample, spot)
        grid = self.model.program.final_grid(first, second, self.shares(sample, spot)[2])
        return self.model.machine.of(grid)

    def rows(self, sample: int, spot: Spot) -> list[Number]:
        """Two (S, S)."""
        own = self.fed("warp.rows")
        return self.made_rows(sample, spot) if own is None else [self._stored(row) for row in own[sample]]

    def made_rows(self, sample: int, spot: Spot) -> list[Number]:
        """From the nine maps."""
        targets, shares = self.row_grids(sample, spot), self.shares(sample, spot)
        return list(self.model.program.rows(self.maps(spot), self.grids(spot), targets, shares))

    def made_image(self, sample: int, spot: Spot) -> Number:
        """(S, S) from the rows."""
        grids, rows = self.row_grids(sample, spot), self.rows(sample, spot)
        image = self.model.program.finished(rows, grids, self.grid(sample, spot), self.shares(sample, spot))
        return self.model.machine.of(image)

    def map(self, sample: int) -> Map:
        """What is projected for a sample."""
        if sample not in self._maps:
            shared = self.right is not None and ("warp.image" in self.handed or not self.model.changes(MAPPED))
            self._maps[sample] = self.right.map(sample) if shared and self.right else self._map(sample)
        return self._maps[sample]

    @cached_property
    def _maps(self) -> dict[int, Map]:
        return {}

    def _map(self, sample: int) -> Map:
        own = self.own("warp.image")
        if own is not None:
            bad = ~np.isfinite(own[sample])
            texels = np.where(bad, self.reference("warp.image")[sample], own[sample])
            # A map that is rendered was cleared to 1; a warped one holds mixes, rounded to 1 or not.
            return Map.of(stored(texels, self.device, exact(1.0, self.device) if self.direct else None), bad)
        if self.direct and self.model.program.right(*RENDERED):
            program = self.model.program
            clip, raster = program.sample_clip(program.places[sample]), program.direct_raster(self.model.machine)
            return rendered(self.model, raster, clip, self.reference("warp.image")[sample])
        return Map.of(self.model.bounded(self.made_map(sample)))

    def made_map(self, sample: int) -> Number:
        """(S, S) whichever of the legal places a sample finds."""
        program = self.model.program
        if not self.warps:
            if self.right is not None and not self.model.changes(DRAWN):
                program.grid_images = self.right.model.program.grid_images
            return self.model.machine.of(program.sample_map(program.places[sample]))
        first, *others = (self.made_image(sample, spot) for spot in self.places(sample))
        found: Number = self.model.machine.either(first, *(lambda x=x: x for x in others))
        return found
