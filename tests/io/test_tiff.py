"""TIFF: files of a plain writer, beside Pillow, and headers that lie."""

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from ibr_ref import io
from ibr_ref.io import tiff
from tests.io import tiff_writer
from tests.io.test_images import check_refused

chance = np.random.default_rng(4)
KINDS = ["u1", "u2", "u4", "i1", "i2", "i4", "f2", "f4", "f8"]
LAYOUTS = [{}, {"order": ">"}, {"rows": 99}, {"tile": 16}, {"tile": 16, "deflate": True, "order": ">"}]
PILLOW = [(kind, layout) for kind in ("u1", "u2", "i2", "i4", "f4") for layout in range(4)]
"""What Pillow has a mode for; compressed big-endian samples it returns with their bytes exchanged."""


def samples(kind, shape=(21, 37)):
    return (chance.random(shape) * 100 - (0 if kind[0] == "u" else 50)).astype(kind)


@pytest.mark.parametrize("layout", range(len(LAYOUTS)))
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("shape", [(21, 37), (21, 37, 3), (1, 1)])
def test_files_of_a_plain_writer(tmp_path, kind, layout, shape):
    values = samples(kind, shape)
    (tmp_path / "a.tif").write_bytes(tiff_writer.encode(values, **LAYOUTS[layout]))
    found = io.read_values(tmp_path / "a.tif")
    assert found.dtype.newbyteorder("=") == values.dtype
    np.testing.assert_array_equal(found, values)


@pytest.mark.parametrize(("kind", "layout"), PILLOW)
def test_beside_pillow(kind, layout):
    data = tiff_writer.encode(samples(kind), **LAYOUTS[layout])
    np.testing.assert_array_equal(tiff.decode(data).samples, np.asarray(Image.open(BytesIO(data))))


@pytest.mark.parametrize("compression", ["tiff_lzw", "tiff_adobe_deflate", "packbits", "raw"])
@pytest.mark.parametrize("kind", ["u1", "u2", "f4"])
def test_files_of_pillow(compression, kind):
    values, stream = samples(kind), BytesIO()
    Image.fromarray(values).save(stream, "TIFF", compression=compression)
    found = tiff.decode(stream.getvalue())
    np.testing.assert_array_equal(found.samples, values)
    assert found.white == {"u1": 255, "u2": 65535, "f4": None}[kind]


@pytest.mark.parametrize("bits", [1, 8, 16])
def test_white_is_zero(bits):
    kind = "u2" if bits == 16 else "u1"
    values = (chance.random((9, 8)) * 2**bits).astype(kind)
    if bits == 1:
        packed = np.packbits(values, axis=1)
        data = tiff_writer.encode(packed, white_is_zero=True, lies=[(256, "I", [8]), (258, "H", [1])])
    else:
        data = tiff_writer.encode(values, white_is_zero=True)
    found = tiff.decode(data)
    assert found.white == 2**bits - 1
    np.testing.assert_array_equal(found.samples, 2**bits - 1 - values)


def test_the_orientation_turns_it():
    values = samples("f4")
    data = tiff_writer.encode(values, tags=[(274, "H", [6])])
    np.testing.assert_array_equal(tiff.decode(data).samples, np.rot90(values, -1))


@pytest.mark.parametrize("tile", [None, 16])
def test_blocks_that_were_left_out_hold_the_nodata_value(tile):
    values = samples("f4")
    data = tiff_writer.encode(values, tile=tile, rows=16, sparse=(1,), tags=[(42113, "s", b"-9999\0")])
    rows, columns = (slice(16, 21), slice(0, 37)) if tile is None else (slice(0, 16), slice(16, 32))
    values[rows, columns] = -9999
    np.testing.assert_array_equal(tiff.decode(data).samples, values)


WHOLE = tiff_writer.encode(samples("f4"))
TILED = tiff_writer.encode(samples("f4"), tile=16, deflate=True)


def lying(*lies, **layout):
    return tiff_writer.encode(samples("f4"), lies=lies, **layout)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (WHOLE[:-1], "TIFF image"),
        (WHOLE[:50], "damaged TIFF image of 50 bytes"),
        (WHOLE[:8], "damaged TIFF image of 8 bytes"),
        (WHOLE[:4], "damaged TIFF image of 4 bytes"),
        (TILED[:60] + b"\xff" * 99 + TILED[159:], "damaged TIFF image"),
        (lying((256, "I", [60000]), (257, "I", [60000])), "60000 x 60000 pixels"),
        (lying((256, "I", [16384]), (257, "I", [16000])), "at most 65536 bytes of them a byte"),
        (lying((322, "I", [2**30]), (323, "I", [2**30]), tile=16), "1073741824 x 1073741824 pixels"),
        (lying((257, "I", [99999])), "truncated TIFF image of 5 strips or tiles"),
        (lying((273, "I", [8, 8, 8, 2**31, 8]), rows=5), "truncated TIFF image of 5 strips or tiles"),
        (lying((279, "I", [1, 1, 1, 1, 1])), "damaged TIFF image"),
        (lying((259, "H", [7])), "compression 7, predictor 1, allowed: none, LZW"),
        (lying((262, "H", [3])), "colours of kind 3, 1 samples"),
        (lying((262, "H", [5]), (277, "H", [4])), "colours of kind 5, 4 samples"),
        (lying((277, "H", [60000])), "TIFF image"),
        (lying((339, "H", [6])), "TIFF image"),
    ],
)
def test_headers_that_lie(tmp_path, capfd, data, words):
    (tmp_path / "a.tif").write_bytes(data)
    check_refused(io.read_values, tmp_path / "a.tif", words)
    assert capfd.readouterr() == ("", "")
