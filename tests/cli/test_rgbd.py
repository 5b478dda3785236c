"""`ibr-ref render splatting --rgbd`."""

from __future__ import annotations

from pathlib import Path

import imageio.v3 as imageio
import numpy as np
import pytest

from ibr_ref import io
from ibr_ref.cli import depth_set_options, options
from ibr_ref.io.depth_sets.conventions import CHOICES
from ibr_ref.io.depth_sets.formats import FORMATS, READ_BY
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line
from tests.io.depth_sets import shots, writers
from tests.io.depth_sets.test_formats import npy, pair

LAW = ("--law", "2,0,0,1")
OWN = ("--convention", "opencv", "--poses", "camera_to_world", "--along", "axis", "--pixel-centers", "integer")


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    folder = tmp_path / "scene"
    folder.mkdir()
    return writers.open3d(folder, shots.shots(hole=False))


def drawn(run: Run, folder: Path, *more: object) -> np.ndarray:
    out = folder.parent / "out.png"
    assert run("render", "splatting", "--rgbd", folder, *LAW, "--out", out, *more) == (0, "", "")
    return imageio.imread(out)


def test_a_picture_from_its_own_place(run: Run, scene: Path) -> None:
    """Width 1: every splat covers the pixel that it is from."""
    picture = drawn(run, scene, "--view", "1", "--cameras", "1", "--law", "1,0,0,1")
    assert np.array_equal(picture, shots.shots(hole=False)[1].color)


VIEWS = (
    ("--view", "2"),
    ("--view", "0:1"),
    ("--pose", "1,0,0,0.1,0,1,0,0,0,0,1,-1"),
    ("--eye", "0,0,-1", "--target", "0,0,4", "--up", "0,-1,0", "--size", f"{shots.WIDTH}x{shots.HEIGHT}"),
)


def test_every_view_of_the_set(run: Run, scene: Path) -> None:
    for view in VIEWS:
        picture = drawn(run, scene, "--cameras", "all", *view)
        assert picture.shape == (shots.HEIGHT, shots.WIDTH, 3)
        assert (picture > 0).any(axis=2).mean() > 0.1


def test_a_pose_is_in_the_sets_own_axes(run: Run, scene: Path) -> None:
    """The pose of a picture is its view."""
    numbers = ",".join(map(repr, map(float, shots.shots()[1].pose.reshape(-1))))
    pictures = [drawn(run, scene, *view) for view in (("--view", "1"), (f"--pose={numbers}",))]
    assert np.array_equal(*pictures)


def test_the_report_and_the_photograph(run: Run, scene: Path) -> None:
    out = scene.parent / "out.png"
    code, said, err = run("render", "splatting", "--rgbd", scene, *LAW, "--view", "1", "--report", "--out", out)
    assert (code, err) == (0, "")
    assert "against the photograph" in said


def test_a_view_without_depth(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "scene"
    folder.mkdir()
    (writers.middlebury(folder, pair(), 0.3) / "disp1.pfm").unlink()
    out = tmp_path / "out.png"
    code, said, err = run("render", "splatting", "--rgbd", folder, *LAW, "--view", "1", "--report", "--out", out)
    assert (code, err) == (0, "")
    assert "against the photograph" not in said
    assert_one_line(
        run("render", "splatting", "--rgbd", folder, "--cameras", "1", "--view", "0", "--out", out), "no depth map"
    )


def test_what_is_handed_on(run: Run, scene: Path) -> None:
    """The same picture from what was written; and a point cloud of as many points."""
    more = ("--cameras", "all", "--view", "0:1")
    again, cloud = scene.parent / "again", scene.parent / "cloud.ply"
    first = drawn(run, scene, *more, "--depth-set", again, "--point-cloud", cloud)
    assert np.array_equal(drawn(run, again, *more), first)
    assert (
        f"element vertex {sum(image.mask.sum() for image in io.read_depth_set(scene))}\n".encode() in cloud.read_bytes()
    )


def test_a_rig_is_handed_on(run: Run, cube: Path, tmp_path: Path) -> None:
    size = ("--count", 4, "--reference-size", 32, "--size", "40x30")
    call = (
        "render",
        "splatting",
        "--mesh",
        cube,
        *size,
        *LAW,
        "--out",
        tmp_path / "a.png",
        "--depth-set",
        tmp_path / "set",
    )
    assert run(*call) == (0, "", "")
    assert len(io.read_depth_set(tmp_path / "set")) == 4


def test_nothing_in_view_says_why(run: Run, scene: Path) -> None:
    call = ("render", "splatting", "--rgbd", scene, *LAW, "--eye", "0,0,-3", "--target=0,0,-9", "--up=0,-1,0")
    code, said, err = run(*call, "--out", scene.parent / "out.png")
    assert (code, said) == (0, "")
    assert "nothing is drawn" in err
    assert "behind the eye" in err


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ((), ("--rgbd needs --view", "--pose", "--eye")),
        (("--view", "3"), ("views[0]: found 3", "from 0 to 2")),
        (("--view", "0", "--cameras", "0,7"), ("views[1]: found 7",)),
        (("--view", "0", "--format", "tum"), ("scene",)),
        (("--view", "0", "--format", "kitti"), ("kitti", "auto", "colmap")),
        (("--view", "0", "--max-time-gap", "1"), ("max_time_gap: found 1.0", "open3d")),
        (("--view", "0", "--depth-scale", "0"), ("depth_scale: found 0.0", "> 0")),
        (("--view", "0", "--convention", "opencl"), ("opencl", "opencv", "opengl")),
        (("--view", "0", "--intrinsics", "1,2,3"), ("--intrinsics", "4 numbers")),
        (("--view", "0", "--pose", "1,0,0,0,0,1,0,0,0,0,1,0"), ("--pose: found", "beside --view")),
        (("--pose", "1,2,3"), ("--pose", "12 numbers")),
        (("--pose", "2,0,0,0,0,1,0,0,0,0,1,0"), ("pose[:3, :3]", "a rotation")),
        (("--view", "0", "--eye", "0,0,0"), ("--eye: found", "beside --view 0")),
        (("--view", "0", "--mesh", "cube.obj"), ("--rgbd", "--mesh")),
        (("--view", "0", "--frame", "1"), ("--frame", "--msr")),
        (("--view", "0", "--point-cloud", "no/such/cloud.ply"), ("cloud.ply", "does not exist")),
    ],
)  # fmt: skip
def test_a_bad_option(run: Run, scene: Path, more: tuple[str, ...], words: tuple[str, ...]) -> None:
    out = scene.parent / "out.png"
    assert_one_line(run("render", "splatting", "--rgbd", scene, "--out", out, *more), *words)
    assert not out.exists()


OF_DEPTH_SETS = [
    ("--depth-scale", "1"),
    ("--convention", "opencv"),
    ("--pose", "1,0,0,0,0,1,0,0,0,0,1,0"),
    ("--format", "tum"),
    ("--intrinsics", "1,1,1,1"),
    ("--along", "ray"),
]


@pytest.mark.parametrize(("option", "value"), OF_DEPTH_SETS)
def test_options_of_depth_sets_go_with_them(run: Run, cube: Path, tmp_path: Path, option: str, value: str) -> None:
    call = ("render", "splatting", "--mesh", cube, "--out", tmp_path / "out.png", option, value)
    assert_one_line(run(*call), f"{option}: found", "without --rgbd")


def test_all_cameras_of_a_sequence_are_not_known(run: Run, tmp_path: Path) -> None:
    call = ("render", "splatting", "--msr", tmp_path, "--cameras", "all", "--view", "0", "--out", tmp_path / "out.png")
    assert_one_line(run(*call), "--cameras: found all", "--msr")


def test_a_folder_of_ones_own(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "scene"
    folder.mkdir()
    writers.own(folder, shots.shots(2, hole=False), npy, "npy")
    call = ("render", "splatting", "--rgbd", folder, "--view", "1", "--out", tmp_path / "out.png")
    assert_one_line(run(*call), "convention, poses, along, pixel_centers: found None", "opencv | opengl")
    assert (drawn(run, folder, "--view", "1", *OWN) > 0).any(axis=2).mean() > 0.5


def test_the_words_are_the_readers() -> None:
    assert [value.value for value in depth_set_options.Format] == ["auto", *FORMATS]
    enumerations = {
        "convention": depth_set_options.Convention,
        "poses": depth_set_options.Poses,
        "along": depth_set_options.Along,
        "pixel_centers": depth_set_options.PixelCenters,
    }
    assert {name: tuple(value.value for value in of) for name, of in enumerations.items()} == CHOICES
    assert READ_BY["max_time_gap"] == ("tum",)
    assert "middlebury" not in READ_BY["depth_scale"]


def test_numbers() -> None:
    assert options.intrinsics("525,525,319.5,239.5") == (525, 525, 319.5, 239.5)
    assert str(options.cameras("all")) == "all"
    assert options.cameras("0,2") == (0, 2)
    assert len(options.pose(",".join("1" * 16))) == 16


def test_every_renderers_picture_is_handed_on(run: Run, cube: Path, tmp_path: Path) -> None:
    """Seen from where it was drawn, width 1, it is the same picture."""
    height = tmp_path / "height.png"
    io.write_image(height, np.add.outer(np.arange(8.0), np.arange(8.0)) / 14)
    calls = (
        ("displacement", "--height", height, "--color", height, "--size", "40x30"),
        ("shadows", "--caster", cube, "--method", "traced", "--size", "40x30"),
    )
    for name, *call in calls:
        out, folder, again = (tmp_path / f"{name}{ending}" for ending in (".png", "", "-again.png"))
        assert run("render", name, *call, "--out", out, "--depth-set", folder)[0] == 0
        (image,) = io.read_depth_set(folder)
        assert image.mask.mean() > 0.1
        call = ["--rgbd", folder, "--view", "0", "--law", "1,0,0,1", "--out", again]
        assert run("render", "splatting", *call) == (0, "", "")
        pictures = [imageio.imread(path) for path in (out, again)]
        assert np.array_equal(pictures[0][image.mask], pictures[1][image.mask])
