"""Images: exact round trips, every kind of PNG, and one clear error for whatever is not an image."""

import os
import re
import struct
import subprocess
import sys
import tracemalloc
import zlib
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from PIL import Image

from ibr_ref import io
from tests.io import png_writer

DATA = Path(__file__).parents[2].parent / "shared" / "data"

small = settings(max_examples=25, deadline=None)
grey_or_rgb = array_shapes(min_dims=2, max_dims=2, max_side=9).flatmap(lambda s: st.sampled_from([s, (*s, 3)]))


def shared(name):
    path = DATA / name
    if not path.exists():
        pytest.skip(f"{path} is not there: real inputs are no part of the project")
    return path


def check_refused(read, path, *words):
    """One line that starts with the path and has the words in it."""
    with pytest.raises((OSError, ValueError)) as caught:
        read(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert not [word for word in words if word not in message], message


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One folder for all examples of a Hypothesis test."""
    return tmp_path_factory.mktemp("images")


# Round trips


@small
@given(samples=arrays(np.uint8, grey_or_rgb))
def test_eight_bits_come_back(folder, samples):
    path = folder / "a.png"
    io.write_image(path, samples / 255.0)
    image = io.read_image(path)
    assert image.dtype == np.float64
    np.testing.assert_array_equal(image, samples / 255.0)


@small
@given(samples=arrays(np.uint16, grey_or_rgb))
def test_sixteen_bits_come_back(folder, samples):
    """And Pillow, which keeps the high bytes of colours, agrees on those."""
    path = folder / "a.png"
    io.write_image(path, samples / 65535.0, bits=16)
    np.testing.assert_array_equal(io.read_image(path), samples / 65535.0)
    np.testing.assert_array_equal(np.asarray(Image.open(path)), samples if samples.ndim == 2 else samples >> 8)


@small
@given(image=arrays(np.float32, grey_or_rgb, elements=st.floats(allow_nan=False, width=32)))
def test_floats_come_back_from_exr(folder, image):
    """As they are: below 0, above 1, infinite."""
    io.write_image(folder / "a.exr", image)
    np.testing.assert_array_equal(io.read_values(folder / "a.exr"), image)


@small
@given(image=arrays(np.float64, grey_or_rgb, elements=st.floats(allow_nan=False)))
def test_values_are_clamped_and_rounded_half_up(folder, image):
    path = folder / "a.png"
    io.write_image(path, image)
    expected = np.floor(255.0 * np.minimum(np.maximum(image, 0.0), 1.0) + 0.5)
    np.testing.assert_array_equal(np.asarray(Image.open(path)), expected)


def test_other_floats_masks_and_lists_are_written(tmp_path):
    path = tmp_path / "a.png"
    for image in (np.float32([[0.0, 1.0]]), np.float16([[0.0, 1.0]]), np.array([[False, True]]), [[0.0, 1.0]]):
        io.write_image(path, image)
        np.testing.assert_array_equal(io.read_image(path), [[0.0, 1.0]])


def test_jpeg_is_near(tmp_path):
    y, x = np.mgrid[:48, :64]
    picture = np.stack([x / 63.0, y / 47.0, (x + y) / 110.0], axis=-1)
    for name in ("a.jpg", "a.JPEG"):
        io.write_image(tmp_path / name, picture)
        assert np.abs(io.read_image(tmp_path / name) - picture).max() < 0.03
    io.write_image(tmp_path / "a.jpg", picture[..., 0])
    assert io.read_image(tmp_path / "a.jpg").shape == (48, 64)


def test_the_content_tells_the_format_not_the_name(tmp_path):
    (tmp_path / "a.jpg").write_bytes(png_writer.encode([[51]], 8))
    np.testing.assert_array_equal(io.read_image(tmp_path / "a.jpg"), [[0.2]])


# Every kind of PNG


@pytest.mark.parametrize("interlaced", [False, True])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("bits", [8, 16])
def test_every_bit_of_every_colour_type(tmp_path, bits, channels, interlaced):
    for seed, shape in enumerate([(1, 1), (3, 2), (4, 9), (13, 11)]):
        samples = np.random.default_rng(seed).integers(0, 2**bits, (*shape, channels))
        path = tmp_path / "a.png"
        path.write_bytes(png_writer.encode(samples, bits, interlaced=interlaced))
        expected = samples[..., 0] if channels == 1 else samples
        image = io.read_image(path)
        assert image.dtype == np.float64
        np.testing.assert_array_equal(image, expected / (2.0**bits - 1.0))


@small
@given(samples=arrays(np.uint16, array_shapes(min_dims=2, max_dims=2, max_side=5).map(lambda s: (*s, 3))))
def test_sixteen_bit_rgb_is_exact(folder, samples):
    path = folder / "a.png"
    path.write_bytes(png_writer.encode(samples, 16))
    np.testing.assert_array_equal(io.read_image(path), samples / 65535.0)


@pytest.mark.parametrize("interlaced", [False, True])
@pytest.mark.parametrize("bits", [1, 2, 4])
def test_few_bits(tmp_path, bits, interlaced):
    samples = np.random.default_rng(bits).integers(0, 2**bits, (7, 13))
    path = tmp_path / "a.png"
    path.write_bytes(png_writer.encode(samples, bits, interlaced=interlaced))
    np.testing.assert_array_equal(io.read_image(path), samples / (2.0**bits - 1.0))


@pytest.mark.parametrize("bits", [1, 2, 4, 8])
def test_palettes(tmp_path, bits):
    rng = np.random.default_rng(bits)
    palette = rng.integers(0, 256, (2**bits, 3)).astype(np.uint8)
    alpha = rng.integers(0, 256, 2).astype(np.uint8)  # of the first two entries; the rest is opaque
    samples = rng.integers(0, 2**bits, (5, 6))
    path = tmp_path / "a.png"
    plte, trns = png_writer.chunk(b"PLTE", palette.tobytes()), png_writer.chunk(b"tRNS", alpha.tobytes())
    path.write_bytes(png_writer.encode(samples, bits, color_type=3, before=plte))
    np.testing.assert_array_equal(io.read_image(path), palette[samples] / 255.0)
    path.write_bytes(png_writer.encode(samples, bits, color_type=3, before=plte + trns))
    image = io.read_image(path)
    np.testing.assert_array_equal(image[..., :3], palette[samples] / 255.0)
    np.testing.assert_array_equal(image[..., 3], np.append(alpha, [255] * (2**bits - 2))[samples] / 255.0)


@pytest.mark.parametrize(
    ("bits", "channels", "key"), [(8, 1, (7,)), (16, 1, (7,)), (8, 3, (7, 7, 7)), (16, 3, (7, 7, 7))]
)
def test_a_colour_key_is_not_alpha(tmp_path, bits, channels, key):
    path = tmp_path / "a.png"
    trns = png_writer.chunk(b"tRNS", struct.pack(f">{channels}H", *key))
    path.write_bytes(png_writer.encode(np.full((2, 2, channels), 7), bits, before=trns))
    image = io.read_image(path)
    assert image.shape == ((2, 2) if channels == 1 else (2, 2, 3))
    assert (image == 7 / (2**bits - 1)).all()


def test_gamma_profiles_texts_and_animation_change_nothing(tmp_path):
    bomb = zlib.compress(bytes(1 << 28), 9)
    extras = [
        png_writer.chunk(b"gAMA", struct.pack(">I", 100000)),
        png_writer.chunk(b"iCCP", b"name\0\0" + bomb),
        png_writer.chunk(b"zTXt", b"Comment\0\0" + bomb),
        png_writer.chunk(b"eXIf", b"not Exif"),
        png_writer.chunk(b"acTL", struct.pack(">II", 0, 0)),
    ]
    path = tmp_path / "a.png"
    path.write_bytes(png_writer.encode([[10, 20]], 8, before=b"".join(extras)))
    np.testing.assert_array_equal(io.read_image(path), np.array([[10, 20]]) / 255.0)


def test_sixteen_bit_heights_of_a_real_terrain():
    image = io.read_height(shared("heightmaps/geneva_dsm_16bit.png"))
    assert image.shape == (512, 512)
    steps = image * 65535.0
    assert np.abs(steps - np.rint(steps)).max() < 1e-9
    assert len(np.unique(image)) > 256


@pytest.mark.parametrize("name", ["toy_box_disp.png", "bricks2_disp.jpg"])
def test_real_heights(name):
    height = io.read_height(shared(f"heightmaps/{name}"))
    assert height.ndim == 2
    assert height.min() < 0.1
    assert 0.5 < height.max() <= 1.0


@pytest.mark.parametrize("name", ["toy_box_diffuse.png", "bricks2.jpg"])
def test_real_colours_are_no_heights(name):
    assert io.read_color(shared(f"heightmaps/{name}")).shape[2] == 3
    check_refused(io.read_height, shared(f"heightmaps/{name}"), "found a colour picture")


@pytest.mark.parametrize("name", ["toy_box_normal.png", "bricks2_normal.jpg"])
def test_real_normals_point_up(name):
    normal = 2.0 * io.read_normal(shared(f"heightmaps/{name}")) - 1.0
    assert (normal[..., 2] > 0.0).mean() > 0.99


# The maps of a base polygon


def rgba(tmp_path, color, alpha):
    path = tmp_path / "a.png"
    path.write_bytes(png_writer.encode([[[*color, alpha], [*color, 255]]], 8))
    return path


def test_heights_packed_with_normals(tmp_path):
    path = rgba(tmp_path, (128, 128, 255), 51)
    np.testing.assert_array_equal(io.read_height(path), [[0.2, 1.0]])
    normal, height = io.read_normal_height(path)
    np.testing.assert_array_equal(height, [[0.2, 1.0]])
    np.testing.assert_array_equal(normal, np.array([[[128, 128, 255]] * 2]) / 255.0)
    np.testing.assert_array_equal(io.read_normal(path), normal)
    np.testing.assert_array_equal(io.read_color(path), normal)


def test_grey_with_alpha_is_its_grey(tmp_path):
    np.testing.assert_array_equal(io.read_height(rgba(tmp_path, (50, 51, 54), 0)), [[0.2, 0.2]])
    path = tmp_path / "la.png"
    path.write_bytes(png_writer.encode([[[51, 0], [102, 255]]], 8))
    np.testing.assert_array_equal(io.read_height(path), [[0.2, 0.4]])
    np.testing.assert_array_equal(io.read_color(path), [[[0.2] * 3, [0.4] * 3]])


def test_grey_in_three_channels_is_a_height(tmp_path):
    io.write_image(tmp_path / "a.png", np.full((2, 3, 3), 0.2))
    np.testing.assert_array_equal(io.read_height(tmp_path / "a.png"), np.full((2, 3), 0.2))


def test_grey_as_colour(tmp_path):
    io.write_image(tmp_path / "a.png", np.full((2, 3), 0.2))
    np.testing.assert_array_equal(io.read_color(tmp_path / "a.png"), np.full((2, 3, 3), 0.2))


def test_maps_that_are_not_there(tmp_path):
    check_refused(
        io.read_height, rgba(tmp_path, (50, 51, 55), 255), "found a colour picture", "allowed for heights: grey"
    )
    io.write_image(tmp_path / "grey.png", np.zeros((2, 2)))
    check_refused(io.read_normal, tmp_path / "grey.png", "found a grey image", "allowed for normals: RGB")
    check_refused(io.read_normal_height, tmp_path / "grey.png", "found 1 channels", "4, RGB + alpha")
    io.write_image(tmp_path / "rgb.png", np.zeros((2, 2, 3)))
    check_refused(io.read_normal_height, tmp_path / "rgb.png", "found 3 channels", "4, RGB + alpha")


@pytest.mark.parametrize("read", [io.read_height, io.read_color, io.read_normal, io.read_normal_height])
def test_maps_pass_on_the_errors_of_images(tmp_path, read):
    check_refused(read, tmp_path / "none.png", "No such file")


# Files that are no images


def test_no_such_file_folder_device_or_right(tmp_path, monkeypatch):
    check_refused(io.read_image, tmp_path / "none.png", "cannot be read (No such file or directory)")
    check_refused(io.read_image, tmp_path, "is a folder")
    check_refused(io.read_image, tmp_path / ("x" * 300), "cannot be read (File name too long)")
    os.mkfifo(tmp_path / "pipe.png")
    check_refused(io.read_image, tmp_path / "pipe.png", "is a device or a pipe")
    io.write_image(tmp_path / "a.png", [[0.5]])

    def denied(path):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(Path, "read_bytes", denied)
    check_refused(io.read_image, tmp_path / "a.png", "cannot be read (Permission denied)")


def test_the_kind_of_error_is_kept(tmp_path):
    with pytest.raises(FileNotFoundError):
        io.read_image(tmp_path / "none.png")
    with pytest.raises(IsADirectoryError):
        io.read_image(tmp_path)


def test_a_huge_file_is_not_read(tmp_path):
    with open(tmp_path / "a.png", "wb") as file:
        file.truncate(2**32 + 1)  # sparse: takes no room
    check_refused(io.read_image, tmp_path / "a.png", "found 4294967297 bytes", "allowed")


@pytest.mark.parametrize(
    "data", [b"", b"x", b"hello, world\n", bytes(1000), b"GIF89a" + bytes(100), b"BM" + bytes(100)]
)
def test_other_files(tmp_path, data):
    path = tmp_path / "a.png"
    path.write_bytes(data)
    check_refused(io.read_image, path, "found", "allowed")


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("interlaced", [False, True])
def test_no_part_of_a_png_is_an_image(tmp_path, bits, interlaced):
    samples = np.random.default_rng(0).integers(0, 2**bits, (6, 5, 3))
    whole, path = png_writer.encode(samples, bits, interlaced=interlaced), tmp_path / "a.png"
    for size in range(len(whole)):
        path.write_bytes(whole[:size])
        check_refused(io.read_image, path, "found")


@pytest.mark.parametrize("options", [{}, {"progressive": True}, {"restart_marker_rows": 1}])
@pytest.mark.parametrize("shape", [(40, 50), (40, 50, 3)])
def test_no_part_of_a_jpeg_is_an_image(tmp_path, shape, options):
    samples = np.random.default_rng(0).integers(0, 256, shape, np.uint8)
    stream, path = BytesIO(), tmp_path / "a.jpg"
    Image.fromarray(samples).save(stream, "JPEG", **options)
    whole = stream.getvalue()
    for size in [*range(0, len(whole), 37), len(whole) - 2, len(whole) - 1]:
        path.write_bytes(whole[:size])
        check_refused(io.read_image, path, "found")
    path.write_bytes(whole)
    assert io.read_image(path).shape == shape


def test_a_png_whose_pixels_end_early(tmp_path):
    """All checksums right, the stream properly closed, but rows are missing: Pillow would leave them black."""
    path = tmp_path / "a.png"
    path.write_bytes(png_writer.encode(np.full((2, 4), 128), 8, size=(4, 3)))
    check_refused(io.read_image, path, "found 10 bytes of PNG pixels, 15 needed")


@pytest.mark.parametrize(("bits", "channels"), [(8, 1), (8, 3), (16, 1), (16, 4), (2, 1)])
@pytest.mark.parametrize("interlaced", [False, True])
def test_a_png_cut_anywhere_and_closed(tmp_path, bits, channels, interlaced):
    """Its pixels cut at every byte, in one chunk or in two, checksums and end made right again."""
    samples = np.random.default_rng(0).integers(0, 2**bits, (5, 6, channels))
    whole, path = png_writer.encode(samples, bits, interlaced=interlaced), tmp_path / "a.png"
    at = whole.index(b"IDAT")
    length = int.from_bytes(whole[at - 4 : at])
    pixels, end = whole[at + 4 : at + 4 + length], png_writer.chunk(b"IEND", b"")
    for size in range(length):
        chunks = png_writer.chunk(b"IDAT", pixels[: size // 2]) + png_writer.chunk(b"IDAT", pixels[size // 2 : size])
        for cut in (chunks, png_writer.chunk(b"IDAT", pixels[:size])):
            path.write_bytes(whole[: at - 4] + cut + end)
            check_refused(io.read_image, path, "found", "PNG")
    path.write_bytes(
        whole[: at - 4] + png_writer.chunk(b"IDAT", pixels[:7]) + png_writer.chunk(b"IDAT", pixels[7:]) + end
    )
    assert io.read_image(path).shape[:2] == (5, 6)
    path.write_bytes(whole[: at - 4] + png_writer.chunk(b"IDAT", pixels[:-1] + bytes([pixels[-1] ^ 1])) + end)
    check_refused(io.read_image, path, "damaged PNG image")


@small
@given(at=st.integers(0, 10**6), bit=st.integers(0, 7))
def test_a_flipped_bit_of_a_png_is_found(folder, at, bit):
    data = bytearray(png_writer.encode(np.arange(64).reshape(8, 8), 8))
    data[at % len(data)] ^= 1 << bit
    path = folder / "flipped.png"
    path.write_bytes(data)
    check_refused(io.read_image, path)


@small
@given(at=st.integers(0, 10**6), value=st.integers(0, 255))
def test_a_damaged_jpeg_is_read_or_refused(folder, at, value):
    stream = BytesIO()
    Image.fromarray(np.random.default_rng(0).integers(0, 256, (24, 24, 3), np.uint8)).save(stream, "JPEG")
    data = bytearray(stream.getvalue())
    data[at % len(data)] = value
    path = folder / "damaged.jpg"
    path.write_bytes(data)
    try:
        image = io.read_image(path)
    except (OSError, ValueError) as error:
        assert re.fullmatch(rf"{path}: .+", str(error))  # noqa: PT017 - either way is right
    else:
        assert 0.0 <= image.min() <= image.max() <= 1.0


@pytest.mark.parametrize(("width", "height"), [(0, 5), (5, 0), (0, 0)])
def test_no_pixels(tmp_path, width, height):
    path = tmp_path / "a.png"
    path.write_bytes(png_writer.encode([[1]], 8, size=(width, height)))
    check_refused(io.read_image, path, f"found {width} x {height} pixels", "allowed: 1 x 1 to")


@pytest.mark.parametrize(("width", "height"), [(2**14, 2**14 + 1), (2**31 - 1, 2**31 - 1), (2**32 - 1, 1)])
def test_too_many_pixels(tmp_path, width, height):
    path = tmp_path / "a.png"
    path.write_bytes(png_writer.encode([[1]], 8, size=(width, height)))
    check_refused(io.read_image, path, f"found {width} x {height} pixels", "2^28")


def peak(work):
    """Bytes that Python and NumPy held at most during the work."""
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("size", [(2**14, 2**14), (20000, 13000), (2**28, 1)])
def test_a_header_that_claims_much_allocates_little(tmp_path, monkeypatch, size):
    """Within the limit, but the pixels are not there: no array, no Pillow image, no warning of a bomb."""
    monkeypatch.setattr("PIL.ImageFile.ImageFile.load", pytest.fail)
    path = tmp_path / "a.png"
    path.write_bytes(png_writer.encode([[1]], 8, size=size))
    assert peak(lambda: check_refused(io.read_image, path, "found 2 bytes of PNG pixels")) < 2**20


def test_a_jpeg_header_that_claims_much(tmp_path, monkeypatch):
    monkeypatch.setattr("PIL.ImageFile.ImageFile.load", pytest.fail)
    io.write_image(tmp_path / "a.jpg", np.zeros((8, 8)))
    data = (tmp_path / "a.jpg").read_bytes()
    at = data.index(b"\xff\xc0") + 5
    for height, width in ((65535, 65535), (16384, 16384), (0, 8), (8, 0)):
        (tmp_path / "a.jpg").write_bytes(data[:at] + struct.pack(">HH", height, width) + data[at + 4 :])
        assert peak(lambda: check_refused(io.read_image, tmp_path / "a.jpg")) < 2**20


@pytest.mark.long
def test_a_bomb_stays_small(tmp_path):
    """Some 2^30 bytes of pixels in 1 MB, for an image of 2 x 2: no more is inflated than is needed."""
    path = tmp_path / "a.png"
    pixels = png_writer.chunk(b"IDAT", zlib.compress(bytes(2**28), 9))
    parts = [png_writer.SIGNATURE, png_writer.header(2, 2), pixels, png_writer.chunk(b"IEND", b"")]
    path.write_bytes(b"".join(parts))
    assert peak(lambda: np.testing.assert_array_equal(io.read_image(path), np.zeros((2, 2)))) < 2**26


def test_more_pixels_than_pillow_allows_by_itself(tmp_path, monkeypatch):
    """By default it warns above 89 megapixels, and refuses above 179: 2^28 are ours to allow."""
    monkeypatch.setattr("PIL.Image.MAX_IMAGE_PIXELS", 10)
    for name in ("a.png", "a.jpg"):
        io.write_image(tmp_path / name, np.zeros((40, 50, 3)))
        assert io.read_image(tmp_path / name).shape == (40, 50, 3)


@pytest.mark.parametrize(("bits", "color_type"), [(3, 0), (4, 2), (16, 3), (8, 5), (32, 0), (0, 0)])
def test_headers_outside_the_standard(tmp_path, bits, color_type):
    path = tmp_path / "a.png"
    parts = [png_writer.SIGNATURE, png_writer.header(1, 1, bits, color_type), png_writer.chunk(b"IEND", b"")]
    path.write_bytes(b"".join(parts))
    check_refused(io.read_image, path, "found a PNG header", "allowed")


def test_a_second_header_is_not_believed(tmp_path):
    path = tmp_path / "a.png"
    path.write_bytes(png_writer.encode([[1]], 8, before=png_writer.header(2**31 - 1, 2**31 - 1)))
    check_refused(io.read_image, path, "found the PNG chunks", "one header")


def test_a_palette_that_is_not_there(tmp_path):
    path = tmp_path / "a.png"
    path.write_bytes(png_writer.encode([[1]], 8, color_type=3))
    check_refused(io.read_image, path, "found the PNG chunks", "a palette if it says so")


def test_a_cmyk_jpeg(tmp_path):
    Image.new("CMYK", (8, 8)).save(tmp_path / "a.jpg")
    check_refused(io.read_image, tmp_path / "a.jpg", "CMYK", "allowed: grey or RGB")


def test_memory_that_does_not_suffice(tmp_path, monkeypatch):
    io.write_image(tmp_path / "a.png", [[0.5]])

    def full(*arguments):
        raise MemoryError

    monkeypatch.setattr("ibr_ref.io.png._samples", full)
    check_refused(io.read_image, tmp_path / "a.png", "does not fit in memory")


# Writing


@pytest.mark.parametrize(
    ("name", "image", "words"),
    [
        ("a.gif", [[0.5]], ("the ending '.gif'", ".png, .jpg, .jpeg")),
        ("a", [[0.5]], ("the ending ''",)),
        ("a.png", [0.5], ("shape (1,)", "(H, W) or (H, W, 3)")),
        ("a.png", np.zeros((2, 2, 4)), ("shape (2, 2, 4)",)),
        ("a.png", np.zeros((0, 3)), ("shape (0, 3)", "not empty")),
        ("a.png", np.zeros((2, 2), np.uint8), ("uint8", "floats in [0, 1]")),
        ("a.png", np.zeros((2, 2), complex), ("complex128",)),
        ("a.png", [["a"]], ("found an image of <U1",)),
        ("a.png", [[0.5, np.nan]], ("NaN at [0, 1]",)),
        ("a.jpg", np.zeros((1, 65536)), ("(1, 65536)", "65535")),
        ("none/a.png", [[0.5]], ("folder", "does not exist")),
        ("file/a.png", [[0.5]], ("folder", "does not exist")),
        ("folder.png", [[0.5]], ("is a folder",)),
        ("x" * 300 + ".png", [[0.5]], ("File name too long",)),
    ],
)
def test_what_cannot_be_written(tmp_path, name, image, words):
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.png").mkdir()
    check_refused(lambda path: io.write_image(path, image), tmp_path / name, *words)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder.png"]


WRITERS = [lambda path, bits: io.write_image(path, np.zeros((2, 2, 3)), bits=bits), io.check_image_writable]


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize(
    ("name", "bits"), [("a.png", 12), ("a.png", 0), ("a.png", "8"), ("a.png", 2**9999), ("a.jpg", 16), ("a.exr", 16)]
)
def test_bits_that_cannot_be_written(tmp_path, write, name, bits):
    check_refused(lambda path: write(path, bits), tmp_path / name, "bits = ", "allowed: 8, or 16 in PNG")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("write", WRITERS)
def test_exr_is_not_written_without_the_extra(tmp_path, monkeypatch, write):
    monkeypatch.setitem(sys.modules, "OpenEXR", None)
    check_refused(lambda path: write(path, 8), tmp_path / "a.exr", "found no OpenEXR", "pip install 'ibr_ref[io]'")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("step", ["tempfile.mkstemp", "os.chmod", "os.replace"])
def test_a_folder_that_cannot_be_written(tmp_path, monkeypatch, step):
    def denied(*arguments, **options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(step, denied)
    check_refused(
        lambda path: io.write_image(path, [[0.5]]), tmp_path / "a.png", "cannot be written (Permission denied)"
    )
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
def test_a_full_disk(tmp_path, monkeypatch):
    monkeypatch.setattr("os.fdopen", lambda handle, mode: (os.close(handle), open("/dev/full", mode))[1])  # noqa: SIM115
    check_refused(lambda path: io.write_image(path, [[0.5]]), tmp_path / "a.png", "No space left on device")
    assert not list(tmp_path.iterdir())


def test_an_interrupted_write_leaves_what_was_there(tmp_path, monkeypatch):
    path = tmp_path / "a.png"
    io.write_image(path, [[0.2]])

    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("os.replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        io.write_image(path, [[0.4]])
    assert list(tmp_path.iterdir()) == [path]
    np.testing.assert_array_equal(io.read_image(path), [[0.2]])


def test_a_file_that_is_replaced_has_the_usual_rights(tmp_path):
    path = tmp_path / "a.png"
    io.write_image(path, [[0.2]])
    (tmp_path / "plain").write_text("")
    assert path.stat().st_mode == (tmp_path / "plain").stat().st_mode
    io.write_image(path, [[0.4]])
    np.testing.assert_array_equal(io.read_image(path), [[0.4]])


def test_the_same_image_makes_the_same_bytes(tmp_path):
    image = np.random.default_rng(0).random((16, 16, 3))
    for name in ("a.png", "b.png"):
        io.write_image(tmp_path / name, image)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_importing_io_does_not_import_decoders():
    names = ("PIL", "imageio", "pydantic", "mapbox_earcut", "numba")
    code = f"import sys, ibr_ref.io; print([m for m in {names} if m in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"
