"""MSR 3D Video folders: the conventions against closed forms and real photographs, and one clear error for the rest."""

import shutil

import numpy as np
import pytest

from ibr_ref import io
from tests.io import png_writer
from tests.io.test_images import shared

WIDTH, HEIGHT = 8, 6
NEAR, FAR = 2.0, 10.0
CODES = np.arange(0, 48, dtype=np.uint8).reshape(HEIGHT, WIDTH) * 5
COLORS = np.arange(144).reshape(HEIGHT, WIDTH, 3) / 143.0
K = "20 0.5 3.25\n0 22 2.75\n0 0 1"
STRAIGHT = "1 0 0 0\n0 1 0 0\n0 0 1 0"
TILT = np.array([[0.96, -0.1, 0.26153393], [0.12, 0.99085822, -0.06], [-0.25314298, 0.08898401, 0.96332752]])
"""Not quite a rotation, as printed ones are not."""


def rotation():
    """The nearest rotation to TILT, off by 1e-5."""
    u, _, v = np.linalg.svd(TILT)
    return u @ v + np.array([[0, 1e-5, 0], [0, 0, 0], [0, 0, 0]])


def pose(r, t):
    return "\n".join(" ".join(repr(float(value)) for value in (*row, shift)) for row, shift in zip(r, t, strict=True))


def calibration(index, k=K, pose=STRAIGHT, distortion="0.0\n0.0"):
    return f"{index}\n{k}\n{distortion}\n{pose}\n\n"


def folder_of(folder, text, cameras=(0,), *, name="breakdancers", inside=False, codes=CODES, colors=COLORS, frame=0):
    """A sequence as the data set has it; the pictures here are PNG whatever their names say, so that nothing is lost."""
    (folder / f"calibParams-{name}.txt").write_text(text)
    for camera in cameras:
        place = folder / f"cam{camera}" if inside else folder
        place.mkdir(exist_ok=True)
        samples = np.floor(np.asarray(colors) * 255 + 0.5).astype(np.uint8)
        (place / f"color-cam{camera}-f{frame:03d}.jpg").write_bytes(png_writer.encode(samples, 8))
        depth = np.repeat(codes[..., None], 3, axis=2) if codes.ndim == 2 else codes
        (place / f"depth-cam{camera}-f{frame:03d}.png").write_bytes(png_writer.encode(depth, 8))
    return folder


def read(folder, cameras=(0,), **options):
    return io.read_msr(folder, cameras=cameras, **{"near": NEAR, "far": FAR, **options})


def world_points(image):
    """(H, W, 3) in our world space, by plain NumPy."""
    camera, depth = image.camera, image.depth
    v, u = np.mgrid[: camera.height, : camera.width] + 0.5
    rays = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(camera.intrinsics).T
    view = np.stack([rays[..., 0] * depth, -rays[..., 1] * depth, -depth], axis=-1)
    r, t = camera.view_from_world[:3, :3], camera.view_from_world[:3, 3]
    return (view - t) @ np.linalg.inv(r).T


def metric(codes):
    return 1.0 / (codes / 255.0 * (1.0 / NEAR - 1.0 / FAR) + 1.0 / FAR)


# Conventions


def test_a_camera_along_the_axis_of_the_world(tmp_path):
    """Depth is z then; rows are turned over, columns are not; half a pixel goes to the centres."""
    (image,) = read(folder_of(tmp_path, calibration(0)))
    np.testing.assert_allclose(image.depth, metric(CODES), rtol=4e-16)
    np.testing.assert_array_equal(image.color, np.floor(COLORS * 255 + 0.5) / 255)
    assert np.all(image.mask)
    np.testing.assert_array_equal(image.camera.intrinsics, [[20, -0.5, 3.75], [0, 22, 6 - 0.5 - 2.75], [0, 0, 1]])
    np.testing.assert_array_equal(np.abs(image.camera.view_from_world), np.eye(4))
    assert image.camera.perspective


def test_the_codes_count_along_the_z_of_the_world(tmp_path):
    """Whatever way the camera looks, the world z of its points is what the codes say: -z in our space."""
    text = calibration(3, pose=pose(rotation(), (0.3, -0.2, 0.25)))
    (image,) = read(folder_of(tmp_path, text, (3,)), (3,))
    np.testing.assert_allclose(world_points(image)[..., 2], -metric(CODES), rtol=1e-14)
    assert np.ptp(image.depth / metric(CODES)) > 0.05


def test_points_project_where_the_file_says(tmp_path):
    """In its own space: x = K (R X + t), rows counted from the bottom, centres at integers."""
    r, t = rotation(), np.array([0.3, -0.2, 0.25])
    (image,) = read(folder_of(tmp_path, calibration(0, pose=pose(r, t))))
    theirs = world_points(image) * (1.0, 1.0, -1.0)
    k = np.reshape([float(word) for word in K.split()], (3, 3))
    x = (theirs @ r.T + t) @ k.T
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    np.testing.assert_allclose(x[..., 0] / x[..., 2], columns, rtol=0, atol=1e-12)
    np.testing.assert_allclose(x[..., 1] / x[..., 2], HEIGHT - 1 - rows, rtol=0, atol=1e-12)
    np.testing.assert_allclose(x[..., 2], image.depth, rtol=1e-14)


def test_the_eye_comes_from_the_inverse_matrix_not_the_transpose(tmp_path):
    r, t = rotation(), np.array([30.0, -20.0, 25.0])
    (image,) = read(folder_of(tmp_path, calibration(0, pose=pose(r, t))), near=100.0, far=200.0)
    mirror = np.array([1.0, 1.0, -1.0])
    np.testing.assert_allclose(image.camera.eye[:3], -np.linalg.solve(r, t) * mirror, rtol=0, atol=1e-12)
    assert np.abs(image.camera.eye[:3] + r.T @ t * mirror).max() > 1e-4


def test_the_clip_planes_keep_every_point_of_every_camera(tmp_path):
    poses = [pose(rotation(), shift) for shift in ((0.3, -0.2, 0.25), (0.2, -0.2, 0.4))]
    text = calibration(0, pose=poses[0]) + calibration(1, pose=poses[1])
    images = read(folder_of(tmp_path, text, (0, 1)), (0, 1))
    for image in images:
        for other in images:
            p = np.append(world_points(other).reshape(-1, 3), np.ones((WIDTH * HEIGHT, 1)), axis=1)
            x, y, z, w = image.camera.clip_from_view @ image.camera.view_from_world @ p.T
            seen = (w > 0) & (np.abs(x) <= w) & (np.abs(y) <= w)
            assert seen.sum() > 10
            assert ((z > 0) & (z < w))[seen].all()


def test_folders_by_camera_frames_grey_depths_and_any_order(tmp_path):
    text = calibration(0) + calibration(7, k=K.replace("22", "24"))
    folder_of(tmp_path, text, (0, 7), inside=True, codes=CODES, frame=12)
    (tmp_path / "cam7" / "depth-cam7-f012.png").write_bytes(png_writer.encode(CODES, 8))
    seven, zero, again = read(tmp_path, (7, 0, 7), frame=12)
    assert (seven.camera.intrinsics[1, 1], zero.camera.intrinsics[1, 1]) == (24.0, 22.0)
    np.testing.assert_array_equal(seven.depth, again.depth)
    np.testing.assert_array_equal(seven.depth, zero.depth)


@pytest.mark.parametrize(("name", "near", "far"), [("breakdancers", 44, 120), ("ballet", 42, 130), ("Ballet", 42, 130)])
def test_known_sequences(tmp_path, name, near, far):
    folder_of(tmp_path, calibration(0), name=name, codes=np.array([[0, 255]], np.uint8), colors=np.zeros((1, 2, 3)))
    (image,) = io.read_msr(tmp_path, cameras=(0,))
    np.testing.assert_allclose(image.depth, [[far, near]], rtol=1e-15)
    (image,) = io.read_msr(str(tmp_path), cameras=[0], near=50)
    np.testing.assert_allclose(image.depth, [[far, 50]], rtol=1e-15)


# Real data


@pytest.fixture(scope="module")
def breakdancers():
    return io.read_msr(shared("breakdancers"))


def warped(image, depth, camera):
    """Index of the pixel whose point is the nearest in each pixel of the other view, -1 where there is none."""
    points = world_points(type(image)(color=image.color, depth=depth, camera=image.camera)).reshape(-1, 3)
    view = points @ camera.view_from_world[:3, :3].T + camera.view_from_world[:3, 3]
    plane = np.stack([view[:, 0] / -view[:, 2], view[:, 1] / view[:, 2], np.ones(len(view))], axis=1)
    column, row = np.floor(plane @ camera.intrinsics.T)[:, :2].astype(int).T
    inside = np.flatnonzero((column >= 0) & (column < camera.width) & (row >= 0) & (row < camera.height))
    far_to_near = inside[np.argsort(view[inside, 2], kind="stable")]
    result = np.full((camera.height, camera.width), -1)
    result[row[far_to_near], column[far_to_near]] = far_to_near
    return result


def compared(image, depth, other):
    """PSNR over RGB where covered, in dB, and the part that is covered."""
    index = warped(image, depth, other.camera)
    covered = index >= 0
    difference = image.color.reshape(-1, 3)[index[covered]] - other.color[covered]
    return -10.0 * np.log10(np.mean(difference**2)), covered.mean()


def test_camera_0_seen_from_camera_1_is_the_photograph_of_camera_1(breakdancers):
    """30.5 dB at width 1 with these conventions, and no others (each wrong one costs 5 dB)."""
    first, second = breakdancers
    quality, coverage = compared(first, first.depth, second)
    assert quality >= 30.5
    assert coverage >= 0.91
    quality, coverage = compared(second, second.depth, first)
    assert quality >= 30.5
    assert coverage >= 0.91


def test_depth_along_the_cameras_own_axis_is_wrong(breakdancers):
    first, second = breakdancers
    along_axis = -world_points(first)[..., 2]
    quality, _ = compared(first, along_axis, second)
    assert 24.5 < quality < 26.0


def test_the_real_cameras(breakdancers):
    first, second = breakdancers
    assert first.depth.shape == (768, 1024)
    np.testing.assert_array_equal(
        first.camera.intrinsics, [[1884.19, 0.654998, 514.2], [0, 1887.49, 767.5 - 395.609], [0, 0, 1]]
    )
    for image in (first, second):
        assert world_points(image)[..., 2].min() > -120.000001
        assert world_points(image)[..., 2].max() < -43.999999
        assert image.camera.near < image.depth.min()
        assert image.camera.far > image.depth.max()


# Bad input


def refused(call, *words):
    with pytest.raises((OSError, ValueError)) as caught:
        call()
    message = str(caught.value)
    assert "\n" not in message
    assert not [word for word in words if word not in message], message
    return message


TEXT = calibration(0) + calibration(1)
CALIBRATIONS = {
    "cut off": (TEXT[: len(TEXT) // 2 + 20], "found 31 numbers", "24 a camera"),
    "empty": ("\n", "found 0 numbers"),
    "no number": (TEXT.replace("2.75", "2,75"), "found '2,75'", "finite numbers"),
    "nan": (TEXT.replace("2.75", "nan"), "found 'nan'"),
    "camera 0.5": (calibration(0.5), "camera: found 0.5"),
    "camera -1": (calibration(-1), "camera: found -1"),
    "twice": (calibration(1) + calibration(1), "camera: found 1", "once"),
    "distortion": (calibration(0, distortion="0.0 -0.1"), "camera 0: distortion: found [0.0, -0.1]", "0 and 0"),
    "not invertible": (calibration(0, k=K.replace("22", "0")), "camera 0: intrinsics: found", "invertible"),
    "not upper": (calibration(0, k=K.replace("0 22", "1 22")), "camera 0: intrinsics: found", "[1.0, 22.0"),
    "no rotation": (calibration(0, pose=STRAIGHT.replace("1 0", "1.01 0")), "camera 0: rotation: found", "R^T R"),
    "mirrored": (calibration(0, pose=STRAIGHT.replace("1 0 0 0", "-1 0 0 0")), "camera 0: rotation: found", "det > 0"),
    "looks back": (calibration(0, pose="-1 0 0 0 0 1 0 0 0 0 -1 0"), "camera 0: rotation: found", "towards +Z"),
    "too near": (calibration(0, pose=STRAIGHT.replace("0 0 1 0", "0 0 1 -3")), "camera 0: near: found 2.0", "> 3"),
}


@pytest.mark.parametrize("name", CALIBRATIONS)
def test_bad_calibrations(tmp_path, name):
    text, *words = CALIBRATIONS[name]
    folder_of(tmp_path, text, (0, 1))
    message = refused(lambda: read(tmp_path), *words)
    assert message.startswith(f"{tmp_path / 'calibParams-breakdancers.txt'}: ")


def test_a_camera_that_the_calibration_does_not_have(tmp_path):
    folder_of(tmp_path, TEXT, (0, 1, 2))
    refused(lambda: read(tmp_path, (0, 2)), "calibParams-breakdancers.txt: found no camera 2", "that it has, 0, 1")


def test_missing_files(tmp_path):
    refused(lambda: read(tmp_path / "none"), f"{tmp_path / 'none'}: is no folder")
    refused(lambda: read(tmp_path), f"{tmp_path}: found none, needed: one file calibParams-NAME.txt")
    folder_of(tmp_path, TEXT, (0, 1))
    refused(lambda: read(tmp_path, frame=1), "depth-cam0-f001.png", "No such file")
    (tmp_path / "color-cam1-f000.jpg").unlink()
    refused(lambda: read(tmp_path, (0, 1)), f"{tmp_path / 'color-cam1-f000.jpg'}: ", "No such file")
    (tmp_path / "calibParams-ballet.txt").write_text(TEXT)
    refused(lambda: read(tmp_path), "found calibParams-ballet.txt, calibParams-breakdancers.txt", "one file")


@pytest.mark.parametrize("name", ["color-cam0-f000.jpg", "depth-cam0-f000.png"])
def test_truncated_pictures(tmp_path, name):
    path = folder_of(tmp_path, TEXT) / name
    whole = path.read_bytes()
    for size in (0, 4, 20, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:size])
        assert refused(lambda: read(tmp_path)).startswith(f"{path}: ")


def test_a_truncated_photograph(tmp_path):
    for path in shared("breakdancers").iterdir():
        shutil.copy(path, tmp_path)
    path = tmp_path / "color-cam1-f000.jpg"
    path.write_bytes(path.read_bytes()[:-1000])
    assert refused(lambda: io.read_msr(tmp_path, cameras=(1,))).startswith(f"{path}: ")


def test_colours_of_another_size(tmp_path):
    folder_of(tmp_path, TEXT, colors=COLORS[:4])
    refused(lambda: read(tmp_path), "color-cam0-f000.jpg: found 8 x 4 pixels, allowed: 8 x 6, the size of depth-cam0")


def test_depths_with_unequal_channels_or_others(tmp_path):
    codes = np.repeat(CODES[..., None], 3, axis=2)
    codes[2, 5, 1] += 1
    folder_of(tmp_path, TEXT, codes=codes)
    refused(lambda: read(tmp_path), "depth-cam0-f000.png: found [105, 106, 105] at row 2, column 5", "equal channels")
    folder_of(tmp_path, TEXT, codes=np.repeat(CODES[..., None], 4, axis=2))
    refused(lambda: read(tmp_path), "depth-cam0-f000.png: found 4 channels", "grey, or RGB with equal channels")
    path = tmp_path / "depth-cam0-f000.png"
    path.write_bytes(png_writer.encode(CODES % 16, 4))
    refused(lambda: read(tmp_path), "depth-cam0-f000.png: found 4 bits", "8 or 16")
    io.write_image(tmp_path / "a.jpg", CODES / 255.0)
    (tmp_path / "a.jpg").replace(path)
    refused(lambda: read(tmp_path), "depth-cam0-f000.png: found a file that starts with", "PNG")


def test_sixteen_bits_are_finer_codes(tmp_path):
    folder_of(tmp_path, TEXT)
    (tmp_path / "depth-cam0-f000.png").write_bytes(png_writer.encode(CODES.astype(np.uint16) * 257, 16))
    np.testing.assert_allclose(read(tmp_path)[0].depth, metric(CODES), rtol=4e-16)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"near": 120.0, "far": 44.0}, ("far: found 44.0", "> near = 120")),
        ({"near": 44.0, "far": 44.0}, ("far: found 44.0", "> near = 44")),
        ({"near": 0.0}, ("near: found 0.0", "> 0")),
        ({"near": -1.0}, ("near: found -1.0", "> 0")),
        ({"far": np.inf}, ("far: found inf", "finite")),
        ({"far": "120 m"}, ("far: found '120 m'",)),
        ({"frame": -1}, ("frame: found -1", "0 to 999")),
        ({"frame": 0.5}, ("frame: found 0.5",)),
        ({"cameras": ()}, ("cameras: found ()", "at least one")),
        ({"cameras": 0}, ("cameras: found 0", "a sequence")),
        ({"cameras": (0, -1)}, ("cameras[1]: found -1",)),
        ({"cameras": "01"}, ("cameras[0]: found '0'",)),
    ],
)
def test_bad_arguments(tmp_path, options, words):
    folder_of(tmp_path, TEXT)
    refused(lambda: read(tmp_path, **options), *words)


@pytest.mark.parametrize("options", [{}, {"near": 40.0}, {"far": 130.0}])
def test_planes_that_are_neither_given_nor_known(tmp_path, options):
    folder_of(tmp_path, TEXT, name="lobby")
    field = "far" if "near" in options else "near"
    words = (f"{tmp_path / 'calibParams-lobby.txt'}: {field}: found None", "breakdancers, ballet")
    refused(lambda: io.read_msr(tmp_path, cameras=(0,), **options), *words)
    assert io.read_msr(tmp_path, cameras=(0,), near=2.0, far=10.0)


def test_cameras_without_pictures(tmp_path):
    text = calibration(0) + calibration(1, pose=pose(rotation(), np.array([1.0, 0.5, -0.25])))
    folder = folder_of(tmp_path, text, cameras=(0, 1))
    images = read(folder, (0, 1))
    assert io.has_msr_picture(folder, 0, 1)
    (folder / "depth-cam1-f000.png").unlink()
    assert not io.has_msr_picture(folder, 0, 1)
    (folder / "color-cam1-f000.jpg").unlink()
    cameras = io.read_msr_cameras(folder, (0, 1), WIDTH, HEIGHT, NEAR, FAR)
    for image, camera in zip(images, cameras, strict=True):
        assert np.array_equal(image.camera.view_from_world, camera.view_from_world)
        assert np.array_equal(image.camera.clip_from_view, camera.clip_from_view)
        assert (camera.width, camera.height) == (WIDTH, HEIGHT)
    with pytest.raises(ValueError, match="found no camera 2, allowed: the cameras that it has, 0, 1"):
        io.read_msr_cameras(folder, (2,), WIDTH, HEIGHT, NEAR, FAR)
