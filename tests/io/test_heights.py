"""Height maps of every kind of file, made by formula, and what is said of heights that cannot be used."""

from math import cos, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ibr_ref import io
from ibr_ref.io import exr, pfm
from tests.io import exr_writer, png_writer, tiff_writer
from tests.io.fuzz_heights import tally
from tests.io.test_images import check_refused

SLOPE = np.add.outer(np.arange(9), 10 * np.arange(7)) / 68.0
"""From 0 in the first texel of row 0 to 1 in the last: no symmetry."""
METRES = 400.0 + np.round(SLOPE * 1000.0)
RANGE = {"height_range": (400.0, 1400.0)}
VOID = METRES.copy()
VOID[2, 3:5] = -9999.0
SINGLE, HALF = SLOPE.astype(np.float32), SLOPE.astype(np.float16)
SHORT = np.round(SLOPE * 65535).astype(np.uint16)
BYTE = np.round(SLOPE * 255).astype(np.uint8)
PROJECTED = (34735, "H", [1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, 9001])
NODATA = (42113, "s", b"-9999\0")


def terrarium():
    stored = np.round((METRES + 32768) * 256).astype(int)
    return png_writer.encode(np.stack([stored >> 16, stored >> 8 & 255, stored & 255], axis=2).astype(np.uint8), 8)


FILES = {
    "f4.tif": (tiff_writer.encode(SINGLE, tile=16, deflate=True), SINGLE, {}),
    "f2.tif": (tiff_writer.encode(HALF, order=">"), HALF, {}),
    "f8.tif": (tiff_writer.encode(SLOPE), SLOPE, {}),
    "u1.tif": (tiff_writer.encode(BYTE), BYTE / 255, {}),
    "u2.tif": (tiff_writer.encode(SHORT, tile=16), SHORT / 65535, {}),
    "rgb.tif": (tiff_writer.encode(np.repeat(BYTE[..., None], 3, axis=2)), BYTE / 255, {}),
    "metres.tif": (tiff_writer.encode(METRES.astype(np.int16)), (METRES - 400) / 1000, RANGE),
    "stored.tif": (tiff_writer.encode(METRES.astype(np.uint16)), (METRES - 400) / 1000, RANGE),
    "half.exr": (exr_writer.encode({"height": HALF}), HALF, {}),
    "grey.exr": (exr.encode(np.repeat(SINGLE[..., None], 3, axis=2)), SINGLE, {}),
    "a.exr": (exr_writer.encode({"Y": METRES.astype(np.float32)}, zipped=True), (METRES - 400) / 1000, RANGE),
    "a.pfm": (pfm.encode(SINGLE), SINGLE, {}),
    "a.r16": (SHORT.astype("<u2").tobytes(), SHORT / 65535, {"size": (7, 9)}),
    "a.raw": (METRES.astype(">f4").tobytes(), (METRES - 400) / 1000, {"size": (7, 9), "order": "big", **RANGE}),
    "a.r8": (BYTE.tobytes(), BYTE / 255, {"size": (7, 9)}),
    "anything": (SHORT.astype(">u2").tobytes(), SHORT / 65535, {"size": (7, 9), "order": "big", "kind": "raw"}),
    "terrarium.png": (terrarium(), (METRES - 400) / 1000, {"kind": "terrarium", **RANGE}),
    "16.png": (png_writer.encode(SHORT, 16), SHORT / 65535, {}),
    "8.png": (png_writer.encode(BYTE, 8), (BYTE + 10.0) / 500, {"height_range": (-10.0, 490.0)}),
    "4.png": (png_writer.encode(BYTE >> 4, 4), (BYTE >> 4) / 15, {}),
    "nibble.png": (png_writer.encode(BYTE >> 4, 4), (BYTE >> 4) / 30, {"height_range": (0, 30)}),
}


def written(tmp_path, name, data):
    (tmp_path / name).write_bytes(data)
    return tmp_path / name


@pytest.mark.parametrize("name", FILES)
def test_each_kind_of_file(tmp_path, name):
    data, expected, options = FILES[name]
    found = io.read_height(written(tmp_path, name, data), **options)
    assert found.dtype == np.float64
    np.testing.assert_array_equal(found, expected)


@settings(max_examples=50, deadline=None)
@given(low=st.floats(-1e6, 1e6), span=st.floats(1e-3, 1e6), shares=st.lists(st.floats(0, 1), min_size=1, max_size=9))
def test_a_range_becomes_0_to_1(tmp_path_factory, low, span, shares):
    """In order, within [0, 1], and 0 and 1 are reached exactly."""
    heights = np.array([[low, *np.clip(low + span * np.array(sorted(shares)), low, low + span), low + span]])
    path = written(tmp_path_factory.getbasetemp(), "a.tif", tiff_writer.encode(heights))
    found = io.read_height(path, height_range=(low, low + span))
    assert found.min() == found[0, 0] == 0.0
    assert found.max() == found[0, -1] == 1.0
    assert (np.diff(found) >= 0.0).all()
    np.testing.assert_allclose(found[0] * span + low, heights[0], rtol=0, atol=1e-9 * (span + abs(low)))


def hgt(side):
    """A plane: 2 m a row downwards, 1 m a column."""
    return np.add.outer(2 * np.arange(side), -np.arange(side)).astype(">i2")


def test_hgt_tiles(tmp_path):
    heights = hgt(1201)
    heights[5, 7] = -32768
    path = written(tmp_path, "s34w070.hgt", heights.tobytes())
    check_refused(io.read_height, path, "found 1 of 1442401 texels (the first in row 5, column 7) without a height")
    found = io.read_height_map(path, fill=0.0, height_range=(-2000, 8000))
    heights[5, 7] = 0
    np.testing.assert_array_equal(found.values, (heights + 2000.0) / 10000.0)
    assert found.texel_size == pytest.approx((92.66 * cos(radians(33.5)), 92.66), rel=1e-3)
    renamed = written(tmp_path, "a.bin", heights.tobytes())
    assert io.read_height_map(renamed, kind="hgt", height_range=(-2000, 8000)).texel_size is None


def test_hgt_tiles_of_one_second_of_arc(tmp_path):
    path = written(tmp_path, "N00E010.hgt", hgt(3601).tobytes())
    found = io.read_height_map(path, height_range=(-4000, 8000))
    assert found.values[[0, 3600], [1, 3600]].tolist() == [3999 / 12000, 7600 / 12000]
    assert found.texel_size == pytest.approx((30.89, 30.89), rel=1e-3)


@pytest.mark.parametrize("order", ["<", ">"])
def test_geotiff_has_its_own_scale_size_and_nodata(tmp_path, order):
    metadata = (
        b'<GDALMetadata>\n  <Item name="OFFSET" sample="0" role="offset">100</Item>\n  <Item name="x">7</Item>\n'
        b'  <Item name="SCALE" sample="0" role="scale">0.5</Item>\n  <Item sample="1" role="scale">9</Item>\n'
        b"</GDALMetadata>\0"
    )
    tags = [PROJECTED, NODATA, (33550, "d", [10.0, 20.0, 0.0]), (42112, "s", metadata)]
    path = written(tmp_path, "a.tif", tiff_writer.encode(VOID.astype(np.int16), order=order, tags=tags))
    found = io.read_height_map(path, height_range=(300, 800), fill=425.0)
    heights = np.where(VOID == -9999.0, 425.0, 0.5 * METRES + 100.0)
    np.testing.assert_array_equal(found.values, (heights - 300.0) / 500.0)
    assert (found.low, found.high, found.texel_size) == (300.0, 800.0, (10.0, 20.0))
    check_refused(io.read_height, path, "found 2 of 63 texels (the first in row 2, column 3) without a height (-9999)")


@pytest.mark.parametrize(
    ("tags", "size"),
    [
        ([PROJECTED, (33550, "d", [30.0, 30.0, 0.0])], (30.0, 30.0)),
        ([PROJECTED, (34264, "d", [5.0, 0, 0, 1, 0, -6.0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 1])], (5.0, 6.0)),
        ([PROJECTED, (34264, "d", [5.0, 1, 0, 1, 1, -6.0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 1])], None),  # turned
        ([(34735, "H", [1, 1, 0, 1, 1024, 0, 1, 2]), (33550, "d", [3e-4, 3e-4, 0.0])], None),  # degrees
        (
            [(34735, "H", [1, 1, 0, 3, 1024, 0, 1, 1, 3076, 0, 1, 9001, 4099, 0, 1, 9002]), (33550, "d", [1.0] * 3)],
            None,
        ),
        (
            [(34735, "H", [1, 1, 0, 3, 1024, 0, 1, 1, 3076, 0, 1, 9002, 4099, 0, 1, 9002]), (33550, "d", [1.0] * 3)],
            (1.0, 1.0),
        ),
        ([PROJECTED, (33550, "d", [0.0, 30.0, 0.0])], None),
        ([PROJECTED, (33550, "d", [float("nan"), 30.0, 0.0])], None),
        ([(33550, "d", [30.0, 30.0, 0.0])], None),
        ([PROJECTED], None),
    ],
)
def test_the_size_of_a_texel_where_it_is_a_length_in_the_units_of_the_heights(tmp_path, tags, size):
    path = written(tmp_path, "a.tif", tiff_writer.encode(SINGLE, tags=tags))
    assert io.read_height_map(path).texel_size == size


def test_floats_that_mean_nothing(tmp_path):
    holes = SINGLE.copy()
    holes[4, 5] = np.nan
    nan = written(tmp_path, "a.tif", tiff_writer.encode(holes, tags=[(42113, "s", b"nan\0")]))
    filled = np.where(np.isnan(holes), 0.25, holes)
    np.testing.assert_array_equal(io.read_height(nan, fill=0.25), filled)
    unsaid = written(tmp_path, "a.pfm", pfm.encode(holes))
    check_refused(io.read_height, unsaid, "found 1 of 63 texels (the first in row 4, column 5) with the height nan")
    np.testing.assert_array_equal(io.read_height(unsaid, nodata=float("nan"), fill=0.25), filled)
    holes[4, 5] = np.inf
    check_refused(io.read_height, written(tmp_path, "b.pfm", pfm.encode(holes)), "with the height inf")
    holes[4, 5] = -3.4028235e38
    lowest = written(tmp_path, "c.tif", tiff_writer.encode(holes, tags=[(42113, "s", b"-3.40282346638529e+38\0")]))
    np.testing.assert_array_equal(io.read_height(lowest, fill=0.25), filled)


OUTSIDE = sum(not 500 <= height <= 1300 for height in METRES.flat)
BELOW = sum(share < 0.5 for share in SINGLE.flat)
BAD = [
    ("a.tif", tiff_writer.encode(METRES.astype("f4")), {}, ["found heights from 400 to 1400, 63 of 63", "--height-range"]),
    ("a.tif", tiff_writer.encode(METRES), {"height_range": (500, 1300)}, [f"{OUTSIDE} of 63 texels", "500 to 1300"]),
    ("a.pfm", pfm.encode(SINGLE - 0.5), {}, [f"found heights from -0.5 to 0.5, {BELOW} of 63", "allowed: 0 to 1"]),
    ("a.r16", bytes(126), {}, ["no size", "--height-size"]),
    ("a.r16", bytes(125), {"size": (7, 9)}, ["found 125 bytes", "63, 126, 252 needed for 7 x 9"]),
    ("a.r16", bytes(189), {"size": (7, 9)}, ["found 189 bytes"]),
    ("a.r16", bytes(9), {"size": (2**20, 2**20)}, ["1048576 x 1048576 pixels"]),
    ("a.png", png_writer.encode(BYTE, 8), {"size": (7, 9)}, ["a size for a file that says its own"]),
    ("a.hgt", bytes(2 * 1201 * 1201 - 1), {}, ["found 2,884,801 bytes of HGT tile", "2,884,802 (1201 x 1201)"]),
    ("a.png", png_writer.encode(BYTE, 8), {"kind": "terrarium"}, ["allowed for Terrarium tiles: 8-bit RGB"]),
    ("a.png", png_writer.encode(np.zeros((2, 2, 3), int), 16), {"kind": "terrarium"}, ["Terrarium tiles: 8-bit RGB"]),
    ("a.exr", exr_writer.encode({"R": SINGLE, "G": SINGLE, "B": 1 - SINGLE}), {}, ["found a colour picture"]),
    ("a.exr", exr_writer.encode({"Z": SINGLE, "Y": SINGLE}), {}, ["the EXR channels Y, Z"]),
    ("a.tif", tiff_writer.encode(SINGLE, tags=[(42113, "s", b"none\0")]), {}, ["the nodata value 'none'", "number needed"]),
    ("a.xyz", b"1 2 3\n", {}, ["starts with b'1 2 3\\n'", "allowed: a PNG, JPEG, TIFF, EXR or PFM image"]),
]  # fmt: skip


@pytest.mark.parametrize(("name", "data", "options", "words"), BAD)
def test_what_is_refused(tmp_path, name, data, options, words):
    check_refused(lambda path: io.read_height(path, **options), written(tmp_path, name, data), *words)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"kind": "bmp"}, "kind: found 'bmp', allowed: hgt | raw | terrarium"),
        ({"order": "middle"}, "order: found 'middle', allowed: little | big"),
        ({"size": (0, 5)}, "size: found 0.0, allowed: a whole number from 1"),
        ({"height_range": (5, 5)}, r"height_range: found \[5.0, 5.0\], allowed: two numbers, the first below"),
        ({"height_range": (-1e308, 1e308)}, "height_range: found"),
        ({"height_range": (0, float("nan"))}, "height_range: found"),
        ({"fill": float("nan")}, "fill: found nan"),
        ({"nodata": float("inf")}, "nodata: found inf"),
    ],
)
def test_options_that_are_none(options, words):
    with pytest.raises(ValueError, match=words):
        io.read_height("is not looked at", **options)


@pytest.mark.parametrize(
    ("own", "given", "expected"),
    [
        (None, {}, (1.0, 0.5, 0.15)),
        (None, {"height_scale": 0.3}, (1.0, 0.5, 0.3)),
        (None, {"texel_size": (30.0, 30.0)}, (1.0, 0.5, 1000.0 / 120.0)),
        (None, {"texel_size": (30.0, 60.0), "height_scale": 60.0}, (1.0, 1.0, 0.5)),
        ((10.0, 40.0), {}, (0.5, 1.0, 1000.0 / 80.0)),
        ((10.0, 40.0), {"height_scale": 0.3}, (1.0, 0.5, 0.3)),
        ((10.0, 40.0), {"texel_size": (1.0, 1.0)}, (1.0, 0.5, 250.0)),
    ],
)
def test_proportions(own, given, expected):
    """Two rows of four texels, 1000 m from 0 to 1."""
    heights = io.HeightMap(values=np.zeros((2, 4)), low=500.0, high=1500.0, texel_size=own)
    assert heights.proportions(**given) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    "given", [{"height_scale": 0.0}, {"height_scale": -1}, {"texel_size": (0, 1)}, {"texel_size": (1, float("nan"))}]
)
def test_proportions_of_nothing(given):
    with pytest.raises(ValueError, match=r"(height_scale|texel_size): found"):
        io.HeightMap(values=np.zeros((2, 4)), low=0.0, high=1.0).proportions(**given)


COLORS = np.stack([SINGLE, 1 - SINGLE, SINGLE * SINGLE], axis=2)


@pytest.mark.parametrize(
    ("name", "data", "expected"),
    [
        ("a.exr", exr_writer.encode({"R": COLORS[..., 0], "G": COLORS[..., 1], "B": COLORS[..., 2]}), COLORS),
        ("a.pfm", pfm.encode(COLORS), COLORS),
        ("a.tif", tiff_writer.encode(COLORS), COLORS),
        ("b.tif", tiff_writer.encode((COLORS * 65535).astype("u2")), (COLORS * 65535).astype("u2") / 65535.0),
        ("c.tif", tiff_writer.encode(BYTE), np.repeat(BYTE[..., None] / 255.0, 3, axis=2)),
    ],
)
def test_colours(tmp_path, name, data, expected):
    found = io.read_color(written(tmp_path, name, data))
    assert found.dtype == np.float64
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("value", [1.5, -0.25, np.nan, np.inf])
def test_colours_that_are_none(tmp_path, value):
    colors = COLORS.copy()
    colors[1, 2, 1] = value
    path = written(tmp_path, "a.pfm", pfm.encode(colors))
    check_refused(io.read_color, path, "found 1 of 189 values outside [0, 1]", f"{value:g} at [1, 2, 1]")


def test_changed_files_are_read_or_refused_in_one_line(tmp_path, capfd):
    count = 500
    found = tally(tmp_path, count, seed=5)
    out, err = capfd.readouterr()
    assert found["read"] + found["refused"] == count, (dict(found), out)
    assert found["read"] > count // 10
    assert found["refused"] > count // 10
    assert (out, err) == ("", "")
