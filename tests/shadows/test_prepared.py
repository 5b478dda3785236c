"""What is made beforehand: nine maps and controls, or a grid of maps, raw or as wavelets; files and bytes."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ibr_ref.shadows import Maps, controls, haar, prepare, prepare_grid, render
from tests.shadows.scenes import Array, ball, params, scene

derandomized = settings(derandomize=True, deadline=None, max_examples=40)

FIELDS = ("positions", "texels", "controls", "content", "samples", "source")


# --- Bytes -----------------------------------------------------------------------------------------------------------


def test_nine_maps_and_controls_at_512_take_less_than_two_and_a_half_megabytes() -> None:
    for k in (1, 4):
        maps = prepare(scene(), params(map_size=512, rows=15, columns=5, map_samples=k))
        assert maps.nbytes == 9 * 512 * 512 + 9 * 15 * 5 * 2 * 8 + 18 * 8
        assert maps.nbytes < 2.5e6
        assert set(np.unique(maps.image * k * k)) <= set(range(k * k + 1))


def test_depths_take_eight_bytes_a_texel() -> None:
    maps = prepare(scene(), params(content="depth"))
    assert maps.nbytes == 9 * 64 * 64 * 8 + 9 * 5 * 4 * 2 * 8 + 18 * 8
    assert maps.image.dtype == np.float64


def test_bytes_are_read_as_the_share_of_samples() -> None:
    """The sum of the coverage is the same for one sample and for many, but for the outline."""
    one, many = (prepare(scene(), params(map_samples=k)).image for k in (1, 5))
    assert abs(one.mean() - many.mean()) < 0.002
    assert ((many > 0) & (many < 1)).any()


# --- Files -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("changes", [{}, {"map_samples": 3}, {"content": "depth"}])
def test_saved_maps_come_back(tmp_path: Path, changes: dict[str, Any]) -> None:
    small = params(**changes)
    maps = prepare(scene(), small)
    maps.save(tmp_path / "maps.npz")
    again = Maps.load(tmp_path / "maps.npz")
    for name in ("positions", "texels", "controls"):
        assert np.array_equal(getattr(again, name), getattr(maps, name))
        assert getattr(again, name).dtype == getattr(maps, name).dtype
    assert (again.content, again.samples, again.source) == (maps.content, maps.samples, maps.source)
    frames = [render(scene(offset=(0.4, 0.3)), small, maps=m, stages=False).color for m in (maps, again)]
    assert np.array_equal(*frames)


def archive(tmp_path: Path, **changes: Any) -> Path:
    """A saved file with other arrays in it; None: left out."""
    maps = prepare(scene(), params(map_size=8))
    arrays = {name: getattr(maps, name) for name in FIELDS} | changes
    path = tmp_path / "changed.npz"
    np.savez(path, **{name: value for name, value in arrays.items() if value is not None})
    return path


DAMAGE: list[tuple[str, Any, str]] = [
    ("positions", None, "no positions"),
    ("positions", np.zeros((3, 3, 2)), "positions"),
    ("positions", np.full((3, 3, 2), np.nan), "positions"),
    ("positions", np.array("here"), "positions"),
    ("texels", np.zeros((3, 3, 8, 9), np.uint8), "texels"),
    ("texels", np.zeros((3, 3, 8, 8), np.float32), "texels"),
    ("texels", np.full((3, 3, 8, 8), 2, np.uint8), "texels"),
    ("texels", np.zeros(3, np.uint8), "texels"),
    ("controls", np.zeros((3, 3, 5, 4)), "controls"),
    ("controls", np.zeros((3, 3, 5, 4, 2)), "folded"),
    ("controls", np.full((3, 3, 5, 4, 2), np.nan), "controls"),
    ("content", np.array("colour"), "content"),
    ("samples", np.array(99), "samples"),
    ("samples", np.zeros(3), "samples"),
    ("source", np.array([None]), "cannot be decoded"),  # objects: only pickles hold them
]


@pytest.mark.parametrize(("name", "value", "message"), DAMAGE, ids=[f"{n}-{i}" for i, (n, _, _) in enumerate(DAMAGE)])
def test_a_file_that_holds_no_maps_is_named(tmp_path: Path, name: str, value: Any, message: str) -> None:
    path = archive(tmp_path, **{name: value})
    with pytest.raises(ValueError, match=message) as error:
        Maps.load(path)
    assert str(error.value).startswith(f"{path}: ")
    assert "\n" not in str(error.value)


def test_files_that_are_no_archives(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="cannot be read"):
        Maps.load(tmp_path / "nothing.npz")
    (tmp_path / "text.npz").write_text("maps")
    with pytest.raises(ValueError, match=r"text\.npz: "):
        Maps.load(tmp_path / "text.npz")
    whole = archive(tmp_path).read_bytes()
    (tmp_path / "cut.npz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match=r"cut\.npz: "):
        Maps.load(tmp_path / "cut.npz")


def test_an_archive_that_unpacks_to_too_much_is_not_unpacked(tmp_path: Path, monkeypatch: Any) -> None:
    path = archive(tmp_path)
    with zipfile.ZipFile(path) as file:
        unpacked = sum(info.file_size for info in file.infolist())
    monkeypatch.setattr("ibr_ref.shadows.prepared._MOST_BYTES", unpacked - 1)
    with pytest.raises(ValueError, match=f"found {unpacked} bytes unpacked"):
        Maps.load(path)


# --- Placement -------------------------------------------------------------------------------------------------------


@derandomized
@given(st.integers(0, 1000), st.integers(2, 9), st.integers(2, 9), st.sampled_from(sorted(controls.PLACEMENTS)))
def test_placements_are_valid(seed: int, rows: int, columns: int, name: str) -> None:
    """Whatever the silhouettes: the border on the border, nothing folded, on the lattice of the window."""
    random = np.random.RandomState(seed)
    images = np.zeros((3, 3, 16, 16))
    for j in range(3):
        for i in range(3):
            x, y = random.randint(0, 17, 2)
            images[j, i, y : y + random.randint(0, 17), x : x + random.randint(0, 17)] = 1.0
    points = controls.place(name, images, rows, columns)
    assert points.shape == (3, 3, rows, columns, 2)
    assert (points[:, :, 0, :, 1] == 0.0).all()
    assert (points[:, :, -1, :, 1] == 1.0).all()
    assert (points[:, :, :, 0, 0] == 0.0).all()
    assert (points[:, :, :, -1, 0] == 1.0).all()
    assert np.array_equal(points * 16 * 256, np.rint(points * 16 * 256))
    for j in range(2):
        for i in range(2):
            s, t = random.random_sample(2)
            top, bottom = (points[j + k, i] * (1 - s) + points[j + k, i + 1] * s for k in range(2))
            for grid in (points[j, i], top, bottom, top * (1 - t) + bottom * t):
                assert controls.folded(grid) is None


def test_a_box_of_points_follows_the_silhouette() -> None:
    images = np.zeros((3, 3, 64, 64))
    for j in range(3):
        for i in range(3):
            images[j, i, 16 + 4 * j : 32 + 4 * j, 20 + 6 * i : 40 + 6 * i] = 1.0
    inner = controls.bounds(images, 5, 4)[:, :, 1:-1, 1:-1]
    assert np.allclose(np.diff(inner[0, :, 0, 0, 0]), 6 / 64)
    assert np.allclose(np.diff(inner[:, 0, 0, 0, 1]), 4 / 64)
    assert inner[0, 0, 0, 0].tolist() == [19 / 64, 15 / 64]
    assert inner[0, 0, -1, -1].tolist() == [41 / 64, 33 / 64]


# --- Grids of maps ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mix", [True, False])
@pytest.mark.parametrize("storage", ["raw", "haar"])
@pytest.mark.parametrize("content", ["mask", "depth"])
def test_a_grid_made_beforehand_gives_what_one_made_on_demand_does(mix: bool, storage: str, content: str) -> None:
    small = params(method="grid", grid_size=3, grid_mix=mix, grid_storage=storage, content=content, light_samples=5)
    grid = prepare_grid(scene(), small)
    for offset in [(0.5, -0.5), (0.13, 0.2)]:
        ours, theirs = (render(scene(offset=offset), small, maps=m) for m in (grid, None))
        assert np.array_equal(ours.color, theirs.color)
        assert np.array_equal(ours.stages["warp.image"], theirs.stages["warp.image"])
    assert grid.storage == storage


def test_wavelets_report_their_size_and_error() -> None:
    small = {"method": "grid", "grid_size": 3, "map_size": 256, "map_samples": 3}
    sphere = scene(caster=ball())
    raw = prepare_grid(sphere, params(**small))
    assert raw.nbytes == 9 * 256 * 256
    assert raw.error == (0.0, 0.0)
    sizes, errors = [], []
    for threshold in (0.0, 0.03, 0.2):
        grid = prepare_grid(sphere, params(**small, grid_storage="haar", grid_threshold=threshold))
        differences = [np.abs(grid.image(j, i) - raw.image(j, i)) for j in range(3) for i in range(3)]
        assert grid.error == pytest.approx((np.max(differences), np.mean(differences)), rel=1e-12)
        sizes.append(grid.nbytes)
        errors.append(grid.error)
    assert raw.nbytes / 10 > sizes[0] > sizes[1] > sizes[2]
    assert errors[0] < errors[1] < errors[2]
    assert errors[0][0] < 12 / 508 + 1 / 510  # twelve details of a texel, each rounded by 1/508, and the mean


# --- Wavelets --------------------------------------------------------------------------------------------------------


def blocks_of(image: Array, threshold: float = 0.0) -> Array:
    return haar.decode(haar.encode(image, threshold), len(image))


@derandomized
@given(st.integers(0, 1000), st.integers(8, 50), st.sampled_from(["noise", "steps", "flat"]))
def test_rounding_alone_changes_little(seed: int, size: int, kind: str) -> None:
    """12 details a texel, each within 1/508, and the mean within 1/510; sizes need be no multiples of 16."""
    random = np.random.RandomState(seed)
    image = random.random_sample((size, size))
    image = np.full((size, size), image[0, 0]) if kind == "flat" else np.rint(image) if kind == "steps" else image
    decoded = blocks_of(image)
    assert np.abs(decoded - image).max() <= 12 / 508 + 1 / 510 + 1e-12
    assert decoded.min() >= 0.0
    assert decoded.max() <= 1.0


def test_masks_of_whole_blocks_are_exact_and_small() -> None:
    image = np.zeros((64, 64))
    image[16:32, 32:64] = 1.0
    blocks = haar.encode(image, 0.0)
    assert np.array_equal(haar.decode(blocks, 64), image)
    assert blocks.nbytes == 16 * (1 + 4)
    assert not len(blocks.data)


def test_a_block_is_decoded_from_its_own_bytes() -> None:
    """Random access: what happens to the bytes of other blocks does not matter."""
    image = np.random.RandomState(0).random_sample((64, 64))
    blocks = haar.encode(image, 0.05)
    begin, end = blocks.start[5], blocks.start[6]
    data = np.zeros_like(blocks.data)
    data[begin:end] = blocks.data[begin:end]
    alone = haar.decode(blocks._replace(data=data), 64)
    inside = (slice(16, 32), slice(16, 32))
    assert np.array_equal(alone[inside], haar.decode(blocks, 64)[inside])


def test_a_single_detail_is_where_the_transform_says() -> None:
    """(a + b)/2 and (a - b)/2 along rows, then columns: a left half of 1 has one detail, 1/2."""
    image = np.zeros((16, 16))
    image[:, :8] = 1.0
    blocks = haar.encode(image, 0.0)
    assert blocks.mean.tolist() == [128]
    assert blocks.data[:32].tolist() == [2] + 31 * [0]
    assert blocks.data[32:].tolist() == [128 + 127]
    image = image.T.copy()
    assert haar.encode(image, 0.0).data[:32].tolist() == [0, 0, 1] + 29 * [0]
