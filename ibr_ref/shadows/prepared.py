"""What is made once for all places of the object: nine maps and their control points."""

from __future__ import annotations

import hashlib
import zipfile
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from os import PathLike
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.array_types import Floats
from ibr_ref.choices import CONTENTS
from ibr_ref.io.files import contents, naming
from ibr_ref.io.outputs import atomic
from ibr_ref.pipeline.transform import transformed
from ibr_ref.scene import Mesh, checks
from ibr_ref.shadows import automatic, maps
from ibr_ref.shadows import controls as placement
from ibr_ref.shadows.inputs import LARGEST_MAP, MOST_CONTROLS, Params, Scene
from ibr_ref.shadows.placement import Placement
from ibr_ref.shadows.samples import check_outside, samples_of, widened_range
from ibr_ref.shadows.selection import Pace
from ibr_ref.shadows.spans import spans
from ibr_ref.shadows.vertex import place
from ibr_ref.shadows.warp import Nine

GIVEN = "given"
"""The placement of control points that were handed in, or of which a file does not say it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Maps:
    """Nine shadow maps of a caster and their control points: all that a frame needs, whatever the caster's size.

    Raises ValueError for arrays of other shapes, positions out of order, and grids that leave the map or are folded.
    """

    positions: Floats
    """(3, 3, 2) the object's offsets, [j, i] = (x_i, y_j)."""
    texels: NDArray[Any]
    """(3, 3, S, S): uint8 counts of covered samples for masks, float64 window depths otherwise."""
    controls: Floats
    """(3, 3, R, C, 2) control points (u, v) in [0, 1]^2."""
    content: str
    """"mask" | "depth"."""
    samples: int
    """k: a mask's texel is its count over k^2."""
    source: str
    """Digest of caster, axes and light, to tell maps of another scene."""
    placement: str = GIVEN
    """How the control points were placed: the name that `prepare` was given, or "given" for points by hand."""
    choice: Placement | None = None
    """How automatic control points were chosen, and what they are expected to reach; None: others were given."""

    def __post_init__(self) -> None:
        checks.choice("content", self.content, CONTENTS)
        checks.whole("samples", self.samples, low=1, high=maps.MOST_SAMPLES)
        size, dtype = self.texels.shape[-1], np.dtype(np.uint8 if self.content == "mask" else np.float64)
        if not 8 <= size <= LARGEST_MAP or self.texels.shape != (3, 3, size, size) or self.texels.dtype != dtype:
            found = f"{self.texels.shape} {self.texels.dtype}"
            raise checks.reject("texels", found, f"(3, 3, S, S) {dtype}, S from 8 to {LARGEST_MAP}")
        self._check_texels()
        x, y = self.lines if self.positions.shape == (3, 3, 2) else ([], [])
        if not x or not (np.isfinite([x, y]).all() and x[0] < x[1] < x[2] and y[0] < y[1] < y[2]):
            raise checks.reject("positions", self.positions.tolist(), "(3, 3, 2) finite and growing")
        check_controls(self.controls)
        for name in ("positions", "texels", "controls"):
            getattr(self, name).setflags(write=False)

    def _check_texels(self) -> None:
        most = self.samples**2 if self.content == "mask" else 1.0
        bad = ~((self.texels >= 0) & (self.texels <= most))
        if bad.any():
            raise checks.reject("texels", self.texels[bad][0].item(), f"from 0 to {most}")

    @property
    def size(self) -> int:
        """S."""
        return int(self.texels.shape[3])

    @property
    def made_with(self) -> dict[str, object]:
        """The fields of `Params` that the maps were made with; others do not fit them."""
        rows, columns = self.controls.shape[2:4]
        return {
            "map_size": self.size,
            "content": self.content,
            "map_samples": self.samples,
            "rows": rows,
            "columns": columns,
        }

    @property
    def lines(self) -> tuple[list[float], list[float]]:
        """The three x and the three y of the positions."""
        return self.positions[0, :, 0].tolist(), self.positions[:, 0, 1].tolist()

    @property
    def levels(self) -> Floats | None:
        """(256,) the values of the texels' bytes; None for depths."""
        return maps.levels(self.samples) if self.content == "mask" else None

    @property
    def image(self) -> Floats:
        """(3, 3, S, S) the maps as numbers from 0 to 1."""
        return maps.values(self.texels, self.samples)

    @cached_property
    def nine(self) -> Nine:
        """The maps as they are warped."""
        outside = 0.0 if self.content == "mask" else 1.0
        return Nine(self.texels, self.levels, spans(self.texels, self.levels, outside), self.controls, outside)

    @property
    def nbytes(self) -> int:
        """Bytes of maps, control points and positions."""
        return self.texels.nbytes + self.controls.nbytes + self.positions.nbytes

    def save(self, path: str | PathLike[str]) -> None:
        """Write a NumPy archive (.npz, no pickles)."""
        chosen: Any = {} if self.choice is None else {"choice": np.array(self.choice.text)}
        with atomic(path) as file:
            np.savez_compressed(
                file,
                positions=self.positions,
                texels=self.texels,
                controls=self.controls,
                content=np.array(self.content),
                samples=np.array(self.samples),
                source=np.array(self.source),
                placement=np.array(self.placement),
                **chosen,
            )

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Maps:
        """Read what `save` wrote. Raises OSError or ValueError that starts with the path for anything else."""
        data = contents(path)
        with naming(path):
            _check_archive(data)
            with np.load(BytesIO(data), allow_pickle=False) as archive:
                arrays = {name: archive[name] for name in _FIELDS}
                placement = str(archive["placement"]) if "placement" in archive else GIVEN
                choice = str(archive["choice"]) if "choice" in archive else None
            for name in ("positions", "controls"):
                arrays[name] = checks.numbers(name, arrays[name], "numbers")
            return cls(
                positions=arrays["positions"],
                texels=np.ascontiguousarray(arrays["texels"]),
                controls=arrays["controls"],
                content=str(arrays["content"]),
                samples=checks.whole("samples", arrays["samples"], low=1, high=maps.MOST_SAMPLES),
                source=str(arrays["source"]),
                placement=placement,
                choice=None if choice is None else Placement.read(choice),
            )


_FIELDS = ("positions", "texels", "controls", "content", "samples", "source")

_MOST_BYTES = 9 * LARGEST_MAP**2 * 8 + 2**24
"""Of an archive once unpacked: the largest maps, and room for the control points."""


def _check_archive(data: bytes) -> None:
    with zipfile.ZipFile(BytesIO(data)) as archive:
        sizes = {info.filename: info.file_size for info in archive.infolist()}
    missing = [name for name in _FIELDS if f"{name}.npy" not in sizes]
    if missing:
        raise ValueError(f"found no {missing[0]}, allowed: an archive with {', '.join(_FIELDS)}")
    if sum(sizes.values()) > _MOST_BYTES:
        raise ValueError(f"found {sum(sizes.values())} bytes unpacked, allowed: at most {_MOST_BYTES}")


def check_controls(controls: Floats) -> None:
    """Raise ValueError for nine grids of another shape, with points outside the map, or folded ones."""
    if controls.ndim != 5 or controls.shape[:2] != (3, 3) or controls.shape[4] != 2:
        raise checks.reject("controls.shape", controls.shape, "(3, 3, R, C, 2)")
    if not (min(controls.shape[2:4]) >= 2 and max(controls.shape[2:4]) <= MOST_CONTROLS):
        raise checks.reject("controls.shape", controls.shape, f"(3, 3, R, C, 2), R and C from 2 to {MOST_CONTROLS}")
    bad = ~((controls >= 0.0) & (controls <= 1.0))
    if bad.any():
        where = np.argwhere(bad)[0].tolist()
        raise checks.reject(f"controls{where}", float(controls[tuple(where)]), "numbers in [0, 1]")
    for j in range(3):
        for i in range(3):
            check_unfolded(f"controls[{j}, {i}]", controls[j, i])


def check_unfolded(field: str, grid: Floats) -> None:
    """Raise ValueError for a grid (R, C, 2) with a triangle whose area is not positive."""
    triangle = placement.folded(grid)
    if triangle is not None:
        cell, half = divmod(triangle, 2)
        row, column = divmod(cell, grid.shape[1] - 1)
        which = f"triangle {half} of the cell at row {row}, column {column} folded or without an area"
        raise checks.reject(field, which, "triangles of positive area, v downwards")


def view_of(scene: Scene, size: int, position: Floats | None = None) -> maps.View:
    """What the maps are rendered of, from the light's centre or from another position."""
    camera = scene.light.camera(size, position)
    return maps.View(
        np.asarray(scene.caster.vertices),
        np.asarray(scene.caster.triangles),
        scene.axes,
        camera.view_from_world,
        camera.clip_from_view,
    )


def depths_of(scene: Scene, params: Params, positions: Floats) -> Floats | None:
    """(3, 3) depth of the middle of the caster's box along the light's view axis, for the nine maps; None: even pace.

    Raises ValueError where it is not in front of the light.
    """
    if params.interpolation == "linear":
        return None
    middle, view = scene.caster.bounds.mean(axis=0), scene.light.camera(1).view_from_world
    places = np.stack([place(middle, scene.axes, offset) for offset in positions.reshape(-1, 2)])
    depths: Floats = -transformed(view, places)[:, 2].reshape(3, 3)
    if not (depths > 0.0).all():
        behind = positions.reshape(-1, 2)[int(depths.argmin())].tolist()
        found = f"projective with the caster at offset {tuple(behind)} not in front of the light"
        raise checks.reject("interpolation", found, "linear, or a light that sees the caster's middle everywhere")
    return depths


_hashed: WeakKeyDictionary[Mesh, Any] = WeakKeyDictionary()
"""Casters' digests, to go on from: a frame must not cost more for a larger caster. Meshes do not change."""


def source_of(scene: Scene) -> str:
    """Digest of all that the maps are rendered of."""
    view = view_of(scene, 1)
    if scene.caster not in _hashed:
        _hashed[scene.caster] = hashlib.sha256(view.vertices.data)
        _hashed[scene.caster].update(view.triangles.data)
    digest = _hashed[scene.caster].copy()
    for array in (view.axes, view.view_from_world, view.clip_from_view):
        digest.update(np.ascontiguousarray(array).data)
    found: str = digest.hexdigest()
    return found


def texels_at(view: maps.View, offset: Floats, params: Params) -> NDArray[Any]:
    """(S, S) one map of the caster at an offset: uint8 counts of samples, or float64 depths."""
    if params.content == "depth":
        return maps.depth(view, offset, params.map_size)
    return maps.mask(view, offset, params.map_size, params.map_samples)


def prepare(
    scene: Scene,
    params: Params | None = None,
    *,
    controls: str | ArrayLike = "fast",
    progress: automatic.Progress | None = None,
) -> Maps:
    """Render the nine maps, and place their control points.

    Maps and controls serve every offset in the scene's range, and `params.light_samples`. controls: "best" or "fast",
    automatic placements (`shadows.automatic`); "bounds" or "identity", simple ones (`shadows.controls`); or points
    (3, 3, R, C, 2) in [0, 1]^2, as given. progress(what, done, total) is called as placement goes on. Raises ValueError
    for a light that is inside the caster at one of the nine places, and for controls of another shape, or folded.
    `Maps.choice` says what automatic controls were chosen, and what they are expected to reach.
    """
    params = Params() if params is None else params
    low, high = widened_range(scene, samples_of(scene, params))
    centre = scene.light.arrays[0]
    positions = maps.positions(low, high, np.array(scene.on_axes(centre)))
    for offset in positions.reshape(-1, 2):
        check_outside("light.position", scene, offset, centre)
    points, chosen = _points(controls, params), None
    view = view_of(scene, params.map_size)
    texels = np.stack([np.stack([texels_at(view, offset, params) for offset in line]) for line in positions])
    if isinstance(points, str):
        images = maps.values(texels, params.map_samples)
        silhouettes = images if params.content == "mask" else (images < 1.0).astype(np.float64)
        points, chosen = _placed(points, scene, params, view, positions, silhouettes, progress)
    return Maps(
        positions=positions,
        texels=texels,
        controls=points,
        content=params.content,
        samples=params.map_samples,
        source=source_of(scene),
        placement=controls if isinstance(controls, str) else GIVEN,
        choice=chosen,
    )


def _placed(
    name: str,
    scene: Scene,
    params: Params,
    view: maps.View,
    positions: Floats,
    silhouettes: Floats,
    progress: automatic.Progress | None,
) -> tuple[Floats, Placement | None]:
    """Control points by a placement's name, and what became of it."""
    size = (params.rows, params.columns)
    if name in placement.PLACEMENTS:
        return placement.place(name, silhouettes, *size, maps.projected_boxes(view, positions)), None
    pace = Pace(depths_of(scene, params, positions), params.policy == "nearest")
    samples = params.map_samples if params.content == "mask" else 1
    nine = automatic.Nine(view, positions, silhouettes, samples, pace)
    placed = automatic.place(name, nine, size, progress)
    return placed.points, Placement(
        asked=name,
        interpolation=params.interpolation,
        places=automatic.RECIPES[name].held_out,
        chosen=placed.chosen,
        others=placed.others,
    )


def _points(value: str | ArrayLike, params: Params) -> str | Floats:
    """The name of a placement, or points of the right shape."""
    if isinstance(value, str):
        checks.choice("controls", value, (*automatic.RECIPES, *placement.PLACEMENTS))
        return value
    points = checks.numbers("controls", value, "a placement's name, or an array (3, 3, R, C, 2)")
    if points.shape != (3, 3, params.rows, params.columns, 2):
        raise checks.reject("controls.shape", points.shape, f"{(3, 3, params.rows, params.columns, 2)}")
    return points
