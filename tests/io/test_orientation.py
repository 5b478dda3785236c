"""The Exif tag Orientation: applied as viewers do, in JPEG and PNG, or not at all."""

from io import BytesIO

import numpy as np
import pytest
from PIL import Image, ImageOps

from ibr_ref import io
from tests.io import png_writer

STORED = np.arange(6 * 8, dtype=np.uint8).reshape(6, 8) * 5


def written(path, orientation, image=STORED):
    exif = Image.Exif()
    exif[0x0112] = orientation
    Image.fromarray(image).save(path, exif=exif)
    return path


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("name", ["a.png", "a.jpg"])
def test_all_eight(tmp_path, name, orientation):
    path = written(tmp_path / name, orientation)
    turned = np.asarray(ImageOps.exif_transpose(Image.open(path)))
    stored = np.asarray(Image.open(path))
    np.testing.assert_array_equal(io.read_image(path), turned / 255.0)
    np.testing.assert_array_equal(io.read_image(path, exif=False), stored / 255.0)
    assert io.read_image(path).flags.c_contiguous


def test_the_first_rows_of_a_turned_picture(tmp_path):
    """By hand: 6 says that the stored rows' left edge is on top."""
    image = io.read_image(written(tmp_path / "a.png", 6))
    np.testing.assert_array_equal(image[0], STORED[::-1, 0] / 255.0)


def test_with_channels_and_sixteen_bits(tmp_path):
    samples = np.random.default_rng(0).integers(0, 2**16, (3, 5, 4))
    exif = Image.Exif()
    exif[0x0112] = 8
    chunk = png_writer.chunk(b"eXIf", exif.tobytes().removeprefix(b"Exif\0\0"))
    (tmp_path / "a.png").write_bytes(png_writer.encode(samples, 16, before=chunk))
    expected = np.rot90(samples) / 65535.0
    np.testing.assert_array_equal(io.read_image(tmp_path / "a.png"), expected)
    np.testing.assert_array_equal(io.read_normal(tmp_path / "a.png"), expected[..., :3])
    normal, height = io.read_normal_height(tmp_path / "a.png", exif=False)
    np.testing.assert_array_equal(height, samples[..., 3] / 65535.0)
    assert normal.shape == (3, 5, 3)


@pytest.mark.parametrize("read", [io.read_height, io.read_color])
def test_maps_are_turned_as_images_are(tmp_path, read):
    path = written(tmp_path / "a.png", 6)
    assert read(path).shape[:2] == (8, 6)
    assert read(path, exif=False).shape[:2] == (6, 8)


@pytest.mark.parametrize("orientation", [0, 9, 65535])
def test_other_values_mean_nothing(tmp_path, orientation):
    np.testing.assert_array_equal(io.read_image(written(tmp_path / "a.png", orientation)), STORED / 255.0)


@pytest.mark.parametrize(
    "exif",
    [b"", b"x", b"II*\0", b"MM\0*" + b"\xff" * 40, b"II*\0\x08\0\0\0\xff\xff" + bytes(8), b"not Exif", bytes(1000)],
)
def test_damaged_tags_mean_nothing(tmp_path, exif):
    (tmp_path / "a.png").write_bytes(png_writer.encode(STORED, 8, before=png_writer.chunk(b"eXIf", exif)))
    np.testing.assert_array_equal(io.read_image(tmp_path / "a.png"), STORED / 255.0)
    stream = BytesIO()
    Image.fromarray(STORED).save(stream, "JPEG", exif=b"Exif\0\0" + exif)
    (tmp_path / "a.jpg").write_bytes(stream.getvalue())
    assert io.read_image(tmp_path / "a.jpg").shape == STORED.shape
