"""JPEG images: what is cut off is refused wherever it was cut, and whatever is whole reads as a plain decoder reads it."""

from io import BytesIO
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image

from ibr_ref import io
from tests.io.test_images import check_refused

END = b"\xff\xd9"

KINDS = {
    "baseline": {},
    "fine": {"quality": 100, "subsampling": 0},
    "coarse": {"quality": 3},
    "4:2:2": {"subsampling": 1},
    "optimized": {"optimize": True},
    "restarts": {"restart_marker_blocks": 2},
    "progressive": {"progressive": True},
    "progressive, 4:4:4": {"progressive": True, "subsampling": 0},
    "progressive, coarse": {"progressive": True, "quality": 5},
    "progressive, restarts": {"progressive": True, "restart_marker_rows": 1},
}


def picture(channels):
    """Slopes and noise, some of it flat: blocks of many bits and of few."""
    y, x = np.mgrid[:37, :51]
    slopes = np.stack([4 * x, 6 * y, 2 * (x + y)], axis=-1)
    slopes[:16, :16] += np.random.default_rng(0).integers(0, 50, (16, 16, 3))
    slopes[20:, 30:] = 90
    samples = np.minimum(slopes, 255).astype(np.uint8)
    return Image.fromarray(samples if channels == 3 else samples[..., 0])


def encoded(kind, channels, **more):
    options = dict(KINDS[kind])
    if channels == 1:
        options.pop("subsampling", None)
    stream = BytesIO()
    picture(channels).save(stream, "JPEG", **options, **more)
    return stream.getvalue()


def plainly(data):
    """As Pillow decodes what it takes for a JPEG, whole or not."""
    return np.asarray(Image.open(BytesIO(data))) / 255.0


@pytest.fixture(params=[(kind, channels) for kind in KINDS for channels in (1, 3)], ids=lambda p: f"{p[0]}, {p[1]}")
def whole(request):
    return encoded(*request.param)


def test_what_is_whole_is_read(tmp_path, whole):
    """Also with what cameras put behind it: zeros, further pictures (MPO), another end marker."""
    path = tmp_path / "a.jpg"
    for data in (whole, whole + bytes(100), whole + whole, whole + END, whole[:-2] + b"\xff\xff\xff" + END):
        path.write_bytes(data)
        np.testing.assert_array_equal(io.read_image(path), plainly(whole))


@pytest.mark.parametrize("end", [END, b"", b"\xff\xd9" + bytes(50), b"\xff" + END])
def test_cut_anywhere_and_closed(tmp_path, whole, end):
    """In every scan, and at each of the last bytes: a plain decoder makes a picture of most of these, grey below."""
    path = tmp_path / "a.jpg"
    last = len(whole) - 2
    for size in {*range(2, last, 5 if end == END else 61), *range(last - 20, last)}:
        path.write_bytes(whole[:size] + end)
        check_refused(io.read_image, path, "found", "JPEG", "allowed")


def test_a_plain_decoder_would_read_them(tmp_path):
    y, x = np.mgrid[:256, :256]
    stream = BytesIO()
    Image.fromarray(((x * y) % 251).astype(np.uint8)).save(stream, "JPEG", quality=90)
    data = stream.getvalue()
    cut = data[: len(data) // 2] + END
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("PIL.ImageFile.LOAD_TRUNCATED_IMAGES", True)
        assert (plainly(cut)[200:] == plainly(cut)[200, 0]).all(), "grey below"
    (tmp_path / "a.jpg").write_bytes(cut)
    check_refused(io.read_image, tmp_path / "a.jpg", "truncated")


def scans(data):
    """Where scans begin, and the end marker."""
    return [i for i in range(len(data) - 1) if data[i : i + 2] == b"\xff\xda"] + [len(data) - 2]


@pytest.mark.parametrize("channels", [1, 3])
def test_progressive_without_some_of_its_scans(tmp_path, channels):
    """Each missing by itself, or from one on."""
    data = encoded("progressive", channels)
    starts = scans(data)
    assert len(starts) > 6
    for i, (start, following) in enumerate(pairwise(starts)):
        for damaged in (data[:start] + data[following:], data[:start] + END):
            (tmp_path / "a.jpg").write_bytes(damaged)
            check_refused(io.read_image, tmp_path / "a.jpg", "JPEG", "allowed")
            if i > 1:
                assert plainly(damaged).shape[:2] == (37, 51), "a plain decoder says nothing"


def test_a_restart_interval_left_out(tmp_path):
    data = encoded("restarts", 3)
    marks = [i for i in range(len(data) - 1) if data[i] == 0xFF and 0xD0 <= data[i + 1] < 0xD8]
    assert len(marks) > 4
    for first, second in pairwise(marks):
        (tmp_path / "a.jpg").write_bytes(data[:first] + data[second:])
        check_refused(io.read_image, tmp_path / "a.jpg", "JPEG")
    (tmp_path / "a.jpg").write_bytes(data[: marks[2]] + b"\xff\xd7" + data[marks[2] + 2 :])
    check_refused(io.read_image, tmp_path / "a.jpg", "JPEG")


def test_one_component_of_three_without_a_scan(tmp_path):
    data = encoded("baseline", 1)
    at = data.index(b"\xff\xc0")
    three = b"\xff\xc0" + (17).to_bytes(2) + data[at + 4 : at + 9] + b"\3" + bytes((1, 17, 0, 2, 17, 0, 3, 17, 0))
    (tmp_path / "a.jpg").write_bytes(data[:at] + three + data[at + 13 :])
    check_refused(io.read_image, tmp_path / "a.jpg", "truncated")


def with_segment(data, marker, body):
    return data[:2] + bytes((0xFF, marker)) + (len(body) + 2).to_bytes(2) + body + data[2:]


def test_thumbnails_comments_and_profiles_change_nothing(tmp_path):
    data = encoded("baseline", 3)
    thumbnail = encoded("coarse", 3)
    for marker, body in (
        (0xE1, b"Exif\0\0" + thumbnail),
        (0xE2, b"ICC_PROFILE\0\1\1?"),
        (0xFE, END),
        (0xED, thumbnail),
    ):
        (tmp_path / "a.jpg").write_bytes(with_segment(data, marker, body))
        np.testing.assert_array_equal(io.read_image(tmp_path / "a.jpg"), plainly(data))


def test_oddities_of_real_files_are_no_damage(tmp_path):
    data = encoded("baseline", 3)
    jfif, scan = data.index(b"JFIF\0") + 5, scans(data)[0]
    odd = [
        data[:jfif] + b"\2" + data[jfif + 1 :],
        data[: scan + 11] + b"\0\0\0" + data[scan + 14 :],
        with_segment(data[:2] + data[20:], 0xEE, b"Adobe\0\x64\0\0\0\0\5"),
    ]
    for changed in odd:
        (tmp_path / "a.jpg").write_bytes(changed)
        np.testing.assert_array_equal(io.read_image(tmp_path / "a.jpg"), plainly(data))


def test_rgb_is_stored_as_rgb(tmp_path):
    stream = BytesIO()
    picture(3).save(stream, "JPEG", keep_rgb=True, quality=95)
    (tmp_path / "a.jpg").write_bytes(stream.getvalue())
    np.testing.assert_array_equal(io.read_image(tmp_path / "a.jpg"), plainly(stream.getvalue()))


@pytest.mark.parametrize(("type_", "words"), [(9, "type 9"), (10, "type 10"), (3, "type 3"), (5, "type 5")])
def test_coding_whose_end_cannot_be_known(tmp_path, type_, words):
    """Arithmetic coding may leave out zeros at its end; hierarchical and lossless files no viewer reads."""
    data = encoded("baseline", 3)
    at = data.index(b"\xff\xc0")
    (tmp_path / "a.jpg").write_bytes(data[: at + 1] + bytes((0xC0 + type_,)) + data[at + 2 :])
    check_refused(io.read_image, tmp_path / "a.jpg", words, "allowed: 0, 1 or 2")


def test_headers_that_are_none(tmp_path):
    data = encoded("baseline", 3)
    at, scan = data.index(b"\xff\xc0"), scans(data)[0]
    frame = data[at : at + 19]
    for changed, words in (
        (data[: at + 4] + b"\x0c" + data[at + 5 :], "12 bits"),
        (data[:at] + data[at + 19 :], "found 0 JPEG frame headers"),
        (data[:at] + frame + data[at:], "found 2 JPEG frame headers"),
        (data[: at + 9] + b"\2" + data[at + 10 :], "frame header of 15 bytes"),
        (data[: scan + 4] + b"\2" + data[scan + 5 :], "scan header of 10 bytes"),
        (data[:at] + b"xx" + data[at:], "no marker"),
        (data[: at + 11] + b"\x31" + data[at + 12 :], "sampling factors"),
    ):
        (tmp_path / "a.jpg").write_bytes(changed)
        check_refused(io.read_image, tmp_path / "a.jpg", words, "allowed")
