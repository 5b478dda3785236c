"""Pictures in bands, and frames of films."""

from __future__ import annotations

import json
from pathlib import Path

import imageio.v3 as imageio
import imageio_ffmpeg
import numpy as np
import pytest

from ibr_ref import io
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line

SHADOWS = ("render", "shadows", "--method", "direct", "--map-size", 32, "--caster")
SPLATTING = ("render", "splatting", "--count", 4, "--reference-size", 32, "--mesh")


@pytest.fixture
def height(tmp_path: Path) -> Path:
    rows, columns = np.mgrid[0:16, 0:16]
    imageio.imwrite(tmp_path / "h.png", np.where((abs(rows - 8) < 4) & (abs(columns - 8) < 4), 200, 0).astype(np.uint8))
    return tmp_path / "h.png"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    cameras = [{"eye": eye, "target": [0, 0, 0]} for eye in ([1.4, -3, 2.1], [-1.4, -3, 1.1])]
    (tmp_path / "path.json").write_text(json.dumps({"cameras": cameras}))
    return tmp_path / "path.json"


def test_bands_are_the_picture(run: Run, cube: Path, height: Path, tmp_path: Path) -> None:
    """Of three bands, each method."""
    for call in ((*SHADOWS, cube), (*SPLATTING, cube), ("render", "displacement", "--height", height)):
        for name in ("out.png", "out.tif"):
            assert run(*call, "--size", "40x530", "--out", tmp_path / name) == (0, "", "")
        picture = imageio.imread(tmp_path / "out.png")
        assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 1
        assert np.array_equal(io.read_values(tmp_path / "out.tif"), picture)


def test_an_empty_poster_says_why(run: Run, height: Path, tmp_path: Path) -> None:
    call = (
        "render",
        "displacement",
        "--height",
        height,
        "--size",
        "40x30",
        "--far",
        "0.1",
        "--out",
        tmp_path / "out.tif",
    )
    code, _, err = run(*call)
    assert (code, err.count("\n")) == (0, 1)
    assert "nothing is drawn" in err


def test_frames_of_a_path(run: Run, cube: Path, height: Path, path: Path, tmp_path: Path) -> None:
    """The first is the picture from there; those that are there stay, and one that is missing comes back."""
    eye = ("--eye", "1.4,-3,2.1", "--target", "0,0,0")
    for number, call in enumerate(
        ((*SHADOWS, cube), (*SPLATTING, cube), ("render", "displacement", "--height", height))
    ):
        folder = tmp_path / str(number)
        folder.mkdir()
        film = (*call, "--size", "40x30", "--path", path, "--frames", 4, "--out", folder / "f.png")
        assert run(*film) == (0, "", "")
        files = sorted(file.name for file in folder.iterdir())
        assert files == ["f-0000.png", "f-0001.png", "f-0002.png", "f-0003.png", "f.film"]
        assert run(*call, "--size", "40x30", *eye, "--out", tmp_path / "one.png") == (0, "", "")
        if number != 1:  # the law of splats is fitted to the view that nothing is said of
            assert np.array_equal(imageio.imread(folder / "f-0000.png"), imageio.imread(tmp_path / "one.png"))
        pictures = [imageio.imread(folder / name) for name in files[:4]]
        assert not np.array_equal(pictures[0], pictures[3])
        imageio.imwrite(folder / "f-0001.png", np.zeros((30, 40, 3), np.uint8))
        (folder / "f-0002.png").unlink()
        assert run(*film) == (0, "", "")
        assert not imageio.imread(folder / "f-0001.png").any(), "it was there"
        assert np.array_equal(imageio.imread(folder / "f-0002.png"), pictures[2])
        assert_one_line(run(*film[:-4], "--frames", 5, *film[-2:]), "f.film", "frames of another film")


def test_on_workers(run: Run, cube: Path, height: Path, path: Path, tmp_path: Path) -> None:
    """Frames and bands are the bytes of this process's, of each method; frames that are there stay."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, protocol="tcp", dashboard_address=None
    ) as cluster:
        for number, call in enumerate(
            ((*SHADOWS, cube), (*SPLATTING, cube), ("render", "displacement", "--height", height))
        ):
            made = {}
            for where in ((), ("--scheduler", cluster.scheduler_address)):
                folder = tmp_path / f"{number}-{len(where)}"
                folder.mkdir()
                film = (*call, "--size", "40x30", "--path", path, "--frames", 4, "--out", folder / "f.png", *where)
                assert run(*film) == (0, "", "")
                (folder / "f-0002.png").unlink()
                assert run(*film) == (0, "", "")
                assert run(*call, "--size", "40x530", "--out", folder / "o.tif", *where) == (0, "", "")
                made[where] = {file.name: file.read_bytes() for file in sorted(folder.iterdir())}
            assert len(made[()]) == 6
            assert len({str(sorted(files.items())) for files in made.values()}) == 1


def test_a_video(run: Run, cube: Path, path: Path, tmp_path: Path) -> None:
    film = (*SHADOWS, cube, "--size", "40x30", "--path", path, "--frames", 5, "--out", tmp_path / "f.png")
    assert run(*film, "--video", tmp_path / "film.mp4", "--fps", 10) == (0, "", "")
    assert imageio_ffmpeg.count_frames_and_secs(tmp_path / "film.mp4")[0] == 5


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--out", "o.tif", "--stages", "s.npz"), ("--stages: found beside --out o.tif", "band by band")),
        (("--out", "o.tif", "--report"), ("--report: found beside --out o.tif",)),
        (("--out", "o.png", "--path", "p.json", "--depth-set", "d"), ("--depth-set: found beside --path p.json",)),
        (("--out", "o.png", "--path", "p.json", "--eye", "1,1,1"), ("--eye", "a camera path has its own cameras")),
        (("--out", "o.png", "--path", "p.json"), ("p.json",)),
        (("--out", "o.png", "--scheduler", "tcp://127.0.0.1:9"), ("--scheduler: found beside --out o.png", "--path")),
        (("--out", "o.png", "--frames", "4"), ("--frames", "beside --path")),
        (("--out", "o.png", "--fps", "4"), ("--fps", "beside --video")),
        (("--out", "o.png", "--path", "p.json", "--video", "o.avi"), ("o.avi: found the ending", ".mp4")),
        (("--out", "o.tif", "--bits", "12"), ("o.tif: found bits = 12", "PNG and TIFF")),
    ],
    ids=lambda value: " ".join(value),
)
def test_what_does_not_go_together(
    run: Run, cube: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, more: tuple[str, ...], words: tuple[str, ...]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert_one_line(run(*SHADOWS, cube, "--size", "40x30", *more), *words)
    assert_one_line(
        run("render", "shadows", "--method", "convolution", "--size", "40x30", "--out", "o.tif"),
        "--method convolution",
        "TIFF",
    )
    assert not [file for file in tmp_path.iterdir() if file.suffix in (".tif", ".png", ".film")]
