"""EXR: files of a plain writer, what is written, and headers that lie."""

import struct
import sys

import numpy as np
import pytest

from ibr_ref import io
from ibr_ref.io import exr
from tests.io import exr_writer
from tests.io.test_images import check_refused

chance = np.random.default_rng(3)
DEPTH = (chance.random((50, 7)) * 9).astype(np.float32)
COLOR = chance.random((50, 7, 3)).astype(np.float32)
CHANNELS = {name: COLOR[..., i] for i, name in enumerate("RGB")}


def read(tmp_path, data, channel=None):
    (tmp_path / "a.exr").write_bytes(data)
    return io.read_values(tmp_path / "a.exr", channel)


@pytest.mark.parametrize("zipped", [False, True])
@pytest.mark.parametrize("kind", ["float16", "float32", "uint32"])
def test_one_channel_of_a_plain_writer(tmp_path, zipped, kind):
    values = DEPTH.astype(kind)
    found = read(tmp_path, exr_writer.encode({"anything": values}, zipped=zipped))
    assert found.dtype == kind
    np.testing.assert_array_equal(found, values)


@pytest.mark.parametrize("zipped", [False, True])
def test_colours_and_a_named_channel(tmp_path, zipped):
    data = exr_writer.encode({**CHANNELS, "A": DEPTH, "Z": DEPTH.astype(np.float16)}, zipped=zipped)
    np.testing.assert_array_equal(read(tmp_path, data, "Z"), DEPTH.astype(np.float16))
    without = exr_writer.encode({**CHANNELS, "A": DEPTH}, zipped=zipped)
    np.testing.assert_array_equal(read(tmp_path, without), COLOR)
    with pytest.raises(ValueError, match=r"channels A, B, G, R, Z, allowed: R, G, B \(and A\), or one"):
        read(tmp_path, data)
    with pytest.raises(ValueError, match="channels A, B, G, R, Z, depth needed"):
        read(tmp_path, data, "depth")


@pytest.mark.parametrize("values", [DEPTH, COLOR, np.full((3, 4), np.nan, np.float32), np.zeros((1, 1))])
def test_what_is_written_comes_back(values):
    np.testing.assert_array_equal(exr.decode(exr.encode(values)), values)


def test_every_compression_of_the_library():
    """Those without loss, and blocks as well as rows."""
    library = pytest.importorskip("OpenEXR")
    from io import BytesIO

    for name in ("NO", "RLE", "ZIPS", "ZIP", "PIZ"):
        for kind in (library.scanlineimage, library.tiledimage):
            header = {"compression": getattr(library, f"{name}_COMPRESSION"), "type": kind}
            if kind == library.tiledimage:
                header["tiles"] = library.TileDescription()
            stream = BytesIO()
            library.File(header, {"Z": DEPTH}).write(stream)
            np.testing.assert_array_equal(exr.decode(stream.getvalue()), DEPTH)


def damaged():
    plane = np.add.outer(np.arange(50), np.arange(7)).astype(np.float32)
    whole = exr_writer.encode({"Z": plane}, zipped=True)
    yield whole[:-1], "truncated or damaged EXR image"
    yield whole[:300], "truncated or damaged EXR image"
    yield whole[:20], "truncated or damaged EXR image"
    yield whole[:-60] + bytes(40) + whole[-20:], "truncated or damaged EXR image"
    yield exr_writer.encode({"Z": DEPTH}, size=(2**15, 2**15)), "found 32768 x 32768 pixels, allowed: 1 x 1 to"
    yield exr_writer.encode({"Z": DEPTH}, size=(2**14, 2**14)), "16384 x 16384 pixels of 1 channels in"
    yield exr_writer.encode({"Z": DEPTH}, window=(0, 0, 99, 99)), "pixels in [[0, 0], [6, 49]] of [[0, 0], [99, 99]]"
    yield exr_writer.encode({"Z": DEPTH}, sampling=2), "EXR"
    yield exr_writer.encode({f"c{i}": DEPTH for i in range(70)}), "70 EXR channels"
    yield whole[:8] + b"channels\0chlist\0" + struct.pack("<i", -1) + whole[8:], "truncated or damaged EXR image"


@pytest.mark.parametrize(("data", "words"), list(damaged()))
def test_headers_that_lie(tmp_path, capfd, data, words):
    """Nor does the library say anything beside."""
    (tmp_path / "a.exr").write_bytes(data)
    check_refused(io.read_values, tmp_path / "a.exr", words)
    assert capfd.readouterr() == ("", "")


def test_a_channel_of_what_has_none(tmp_path):
    (tmp_path / "a.pfm").write_bytes(b"Pf\n1 1\n-1\n" + bytes(4))
    check_refused(lambda path: io.read_values(path, "Z"), tmp_path / "a.pfm", "no EXR image", "'Z'")


@pytest.mark.parametrize("module", ["OpenEXR", "tifffile", "imagecodecs"])
def test_without_the_extra(tmp_path, monkeypatch, module):
    monkeypatch.setitem(sys.modules, module, None)
    path = tmp_path / "a"
    path.write_bytes(exr.SIGNATURE if module == "OpenEXR" else b"II*\0")
    check_refused(io.read_values, path, f"found no {module}, needed for", "pip install 'ibr_ref[io]'")
