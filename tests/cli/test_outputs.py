"""Where the command line writes: pipes, links and standard output."""

from __future__ import annotations

import json
import os
import stat
import threading
from pathlib import Path

import numpy as np
import pytest

from ibr_ref import oracle
from ibr_ref.io import read_image, read_values, write_image
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("cases") / "ball"
    oracle.export(oracle.build("splatting-ball"), folder)
    (folder / "port").mkdir()
    (folder / "port" / "color.npy").write_bytes((folder / "expected" / "color.npy").read_bytes())
    return folder


@pytest.fixture
def height(tmp_path: Path) -> Path:
    write_image(tmp_path / "height.png", np.indices((8, 8)).sum(axis=0) / 14)
    return tmp_path / "height.png"


def rendering(height: Path, out: Path, *more: object) -> tuple[object, ...]:
    return ("render", "displacement", "--height", height, "--size", "12x8", "--out", out, *more)


def read(path: Path) -> tuple[threading.Thread, list[bytes]]:
    """Wait for what is written to a pipe."""
    found: list[bytes] = []
    thread = threading.Thread(target=lambda: found.append(path.read_bytes()), daemon=True)
    thread.start()
    return thread, found


def test_picture_and_stages_into_pipes(run: Run, height: Path, tmp_path: Path) -> None:
    assert run(*rendering(height, tmp_path / "a.png", "--stages", tmp_path / "a.npz")) == (0, "", "")
    readers = []
    for name in ("out.png", "stages"):
        os.mkfifo(tmp_path / name)
        readers.append(read(tmp_path / name))
    assert run(*rendering(height, tmp_path / "out.png", "--stages", tmp_path / "stages")) == (0, "", "")
    for (thread, found), plain in zip(readers, ("a.png", "a.npz"), strict=True):
        thread.join(20)
        assert found == [(tmp_path / plain).read_bytes()]


def test_stages_into_a_process_substitution(run: Run, height: Path, tmp_path: Path) -> None:
    """`--stages >(cat)`: an open descriptor."""
    source, target = os.pipe()
    with os.fdopen(source, "rb") as reader:
        thread, found = threading.Thread(target=lambda: found.append(reader.read()), daemon=True), []
        thread.start()
        assert run(*rendering(height, tmp_path / "a.png", "--stages", f"/dev/fd/{target}")) == (0, "", "")
        os.close(target)
        thread.join(20)
    assert found[0][:2] == b"PK"


def test_a_linked_output(run: Run, height: Path, tmp_path: Path) -> None:
    (tmp_path / "target.npz").touch()
    (tmp_path / "link.npz").symlink_to("target.npz")
    assert run(*rendering(height, tmp_path / "a.png", "--stages", tmp_path / "link.npz"))[0] == 0
    assert (tmp_path / "link.npz").is_symlink()
    assert (tmp_path / "target.npz").stat().st_size > 1000


def test_verdict_and_report_into_pipes(run: Run, case: Path, tmp_path: Path) -> None:
    readers = []
    for name in ("verdict.json", "verdict.html"):
        os.mkfifo(tmp_path / name)
        readers.append(read(tmp_path / name))
    code, *_ = run(
        "check", case, case / "port", "--json", tmp_path / "verdict.json", "--report", tmp_path / "verdict.html"
    )
    assert code == 0
    for thread, _ in readers:
        thread.join(20)
    assert json.loads(readers[0][1][0])["outcome"] == "PASS"
    assert readers[1][1][0].rstrip().endswith(b"</html>")
    assert all(stat.S_ISFIFO(path.stat().st_mode) for path in tmp_path.iterdir())


def test_json_on_standard_output(run: Run, case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing else is there; the words are on standard error."""
    monkeypatch.chdir(tmp_path)
    code, out, err = run("check", case, case / "port", "--json", "-")
    assert code == 0
    assert json.loads(out)["outcome"] == "PASS"
    assert err.startswith("PASS: splatting-ball")
    assert not list(tmp_path.iterdir())


def test_figures_on_standard_output(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    row = {"scene": "box", "width": 64, "height": 48, "linear_steps": 10, "paper_ms": 16.7}
    row |= {"gathers": 1_000_000, "gathers_per_second": 1e9, "gathers_ms": 1.0, "beside_gathers": 1.25}
    times = {f"{what}_{which}_ms": 1.25 for what in ("picture", "stages") for which in ("best", "median")}
    monkeypatch.setattr("ibr_ref.bench.displacement.times", lambda repeat: [{**row, **times}])
    code, out, err = run("bench", "displacement", "--json", "-")
    assert code == 0
    assert json.loads(out) == {"displacement": [{**row, **times}]}
    assert "1.2 (1.2)" in err


def test_a_bench_asks_before_it_measures(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ibr_ref.bench.displacement.times", pytest.fail)
    assert_one_line(run("bench", "displacement", "--json", tmp_path / "none" / "a.json"), "none", "does not exist")


def test_maps_go_to_a_pipe(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They are not read from there."""
    from ibr_ref.cli import shadows_maps

    os.mkfifo(tmp_path / "maps")
    assert not shadows_maps._kept(tmp_path / "maps")
    assert not shadows_maps._kept(tmp_path / "none.npz")
    (tmp_path / "maps.npz").write_bytes(b"x")
    assert shadows_maps._kept(tmp_path / "maps.npz")


@pytest.mark.parametrize("command", [("demo", "--out"), ("reproduce", "1", "--out")])
def test_a_folder_that_cannot_be_made(run: Run, tmp_path: Path, command: tuple[str, ...]) -> None:
    (tmp_path / "file").write_text("x")
    assert_one_line(run(*command, tmp_path / "file"), f"{tmp_path / 'file'}: cannot be made", "a folder is needed")
    assert_one_line(run(*command, tmp_path / "file" / "in"), "cannot be made (Not a directory)")


def test_an_export_through_a_link(run: Run, tmp_path: Path) -> None:
    (tmp_path / "box").symlink_to("real")
    for _ in range(2):  # made, and replaced
        assert run("export", "splatting-ball", tmp_path / "box")[0] == 0
        assert (tmp_path / "box").is_symlink()
        assert (tmp_path / "real" / "case.json").is_file()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["box", "real"]


def test_stored_rows_are_kept(run: Run, height: Path, tmp_path: Path) -> None:
    from PIL import Image

    exif = Image.Exif()
    exif[0x0112] = 8
    stored = Image.open(height)
    turned = stored.transpose(Image.Transpose.ROTATE_270)
    turned.save(tmp_path / "turned.png", exif=exif)  # looks as height.png does
    turned.save(tmp_path / "plain.png")
    pictures = {}
    for name, options in {"height": (), "turned": (), "plain": (), "turned ": ("--no-exif",)}.items():
        out = tmp_path / f"out-{len(pictures)}.png"
        assert run(*rendering(tmp_path / f"{name.strip()}.png", out, *options)) == (0, "", "")
        pictures[name] = out.read_bytes()
    assert pictures["turned"] == pictures["height"] != pictures["plain"] == pictures["turned "]


def test_floats_and_sixteen_bits(run: Run, height: Path, tmp_path: Path) -> None:
    """The frame's own colours; and each rounds to the picture of 8 bits."""
    assert run(*rendering(height, tmp_path / "a.exr", "--stages", tmp_path / "a.npz")) == (0, "", "")
    assert run(*rendering(height, tmp_path / "16.png", "--bits", "16")) == (0, "", "")
    assert run(*rendering(height, tmp_path / "8.png")) == (0, "", "")
    with np.load(tmp_path / "a.npz") as stages:
        color = stages["color"]
    np.testing.assert_array_equal(read_values(tmp_path / "a.exr"), color.astype(np.float32))
    np.testing.assert_array_equal(read_image(tmp_path / "16.png"), np.floor(color * 65535 + 0.5) / 65535)
    np.testing.assert_array_equal(read_image(tmp_path / "8.png"), np.floor(color * 255 + 0.5) / 255)
    assert_one_line(
        run(*rendering(height, tmp_path / "b.exr", "--bits", "16")), "found bits = 16, allowed: 8, or 16 in PNG"
    )
    assert_one_line(run(*rendering(height, tmp_path / "b.png", "--bits", "10")), "found bits = 10")
    assert not (tmp_path / "b.exr").exists()


def test_floats_into_a_pipe(run: Run, height: Path, tmp_path: Path) -> None:
    assert run(*rendering(height, tmp_path / "a.exr")) == (0, "", "")
    os.mkfifo(tmp_path / "out.exr")
    thread, found = read(tmp_path / "out.exr")
    assert run(*rendering(height, tmp_path / "out.exr")) == (0, "", "")
    thread.join(20)
    assert found == [(tmp_path / "a.exr").read_bytes()]


def test_out_of_memory_is_a_line(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*scene: object, **options: object) -> None:
        raise MemoryError("12.0 GiB are needed")

    monkeypatch.setattr("ibr_ref.displacement.render", refused)
    write_image(tmp_path / "h.png", np.zeros((4, 4)))
    found = run("render", "displacement", "--height", tmp_path / "h.png", "--out", tmp_path / "a.png")
    assert_one_line(found, "out of memory: 12.0 GiB are needed")
