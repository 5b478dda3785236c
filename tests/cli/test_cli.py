"""The command line: what it writes, and that every bad input ends in one line and exit code 2."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import imageio.v3 as imageio
import numpy as np
import pytest

from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line


@pytest.fixture
def maps(tmp_path: Path) -> dict[str, Path]:
    """A small height map, 16 bits, and a colour map."""
    rows, columns = np.mgrid[0:16, 0:24]
    height = np.where((abs(rows - 8) < 3) & (abs(columns - 12) < 4), 60000, 0).astype(np.uint16)
    color = np.stack([rows * 15, columns * 10, 255 - rows * 10], axis=-1).astype(np.uint8)
    paths = {"height": tmp_path / "height.png", "color": tmp_path / "color.png"}
    imageio.imwrite(paths["height"], height)
    imageio.imwrite(paths["color"], color)
    return paths


def arguments(maps: dict[str, Path], out: Path, *more: object) -> tuple[object, ...]:
    return (
        *("render", "displacement", "--height", maps["height"], "--color", maps["color"]),
        *("--size", "40x30", "--out", out, *more),
    )


def test_it_runs_as_a_module() -> None:
    found = subprocess.run([sys.executable, "-m", "ibr_ref", "--version"], capture_output=True, text=True, check=False)
    assert (found.returncode, found.stderr) == (0, "")
    assert found.stdout.startswith("ibr-ref ")


def test_help_does_not_import_numba() -> None:
    code = "import sys; from ibr_ref import cli; sys.argv = ['ibr-ref', '--help']\n"
    code += "try: cli.main()\nexcept SystemExit: pass\n"
    code += "assert not {'numba', 'numpy', 'scipy'} & set(sys.modules), 'slow imports'"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert "displacement" not in result.stderr


@pytest.mark.parametrize(
    "command",
    [(), ("render",), ("demo",), ("export",), ("bench",), ("render", "displacement"), ("render", "splatting")],
    ids=lambda c: " ".join(c) or "ibr-ref",
)
def test_every_command_has_help(run: Run, command: tuple[str, ...]) -> None:
    code, out, err = run(*command, "--help")
    assert code == 0
    assert "Usage" in out
    assert not err


def test_examples_are_in_the_help(run: Run) -> None:
    for command in (("demo",), ("bench",), ("render", "displacement"), ("render", "splatting")):
        assert "ibr-ref " + " ".join(command) in run(*command, "--help")[1]


def test_version(run: Run) -> None:
    code, out, _ = run("--version")
    assert code == 0
    assert out.startswith("ibr-ref 0.")


def test_render_writes_the_picture_and_the_stages(run: Run, maps: dict[str, Path], tmp_path: Path) -> None:
    out, stages = tmp_path / "out.png", tmp_path / "dump.npz"
    assert run(*arguments(maps, out, "--stages", stages)) == (0, "", "")
    assert imageio.imread(out).shape == (30, 40, 3)
    with np.load(stages, allow_pickle=False) as dump:
        assert dump["march.hit_index"].shape == (30, 40)
        assert (dump["march.hit"][..., 2] > 0.5).any(), "the raised part is not in the picture"
        assert np.array_equal(np.floor(dump["color"] * 255 + 0.5), imageio.imread(out))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["color.png", "dump.npz", "height.png", "out.png"]


def test_the_image_is_not_mirrored(run: Run, tmp_path: Path) -> None:
    """Seen from above, the top left corner of the colour map is the top left corner of the picture."""
    height, color, out = tmp_path / "h.png", tmp_path / "c.png", tmp_path / "out.png"
    imageio.imwrite(height, np.zeros((4, 4), np.uint8))
    image = np.full((4, 4, 3), 255, np.uint8)
    image[:2, :2] = (255, 0, 0)
    imageio.imwrite(color, image)
    run(
        "render",
        "displacement",
        "--height",
        height,
        "--color",
        color,
        "--out",
        out,
        "--eye",
        "0,0,2",
        "--size",
        "64x64",
    )
    picture = imageio.imread(out)
    red = (picture[..., 0] > 100) & (picture[..., 1] < 50)
    assert red[21:27, 21:27].all()
    assert not red[34:, :].any()
    assert not red[:, 34:].any()


def test_packed_normal_height(run: Run, maps: dict[str, Path], tmp_path: Path) -> None:
    packed = np.full((16, 24, 4), 128, np.uint8)
    packed[..., 2] = 255
    packed[..., 3] = imageio.imread(maps["height"]) // 257
    imageio.imwrite(tmp_path / "packed.png", packed)
    result = run(
        *("render", "displacement", "--normal-height", tmp_path / "packed.png", "--size", "40x30"),
        *("--out", tmp_path / "out.png"),
    )
    assert result == (0, "", "")


@pytest.mark.parametrize("mode", ["1", "P", "L", "RGB"])
def test_any_grey_png_is_a_height_map(run: Run, maps: dict[str, Path], tmp_path: Path, mode: str) -> None:
    from PIL import Image

    grey = Image.fromarray((imageio.imread(maps["height"]) // 257).astype(np.uint8))
    grey.convert(mode).save(tmp_path / "h.png")
    maps["height"] = tmp_path / "h.png"
    assert run(*arguments(maps, tmp_path / "out.png"))[0] == 0


@pytest.mark.parametrize(
    "content", [b"", b"not an image", b"\x89PNG\r\n\x1a\n", None], ids=["empty", "text", "stub", "cut"]
)
def test_a_bad_height_map(run: Run, maps: dict[str, Path], tmp_path: Path, content: bytes | None) -> None:
    whole = maps["height"].read_bytes()
    maps["height"].write_bytes(whole[: len(whole) // 2] if content is None else content)
    assert_one_line(run(*arguments(maps, tmp_path / "out.png")), str(maps["height"]))
    assert not (tmp_path / "out.png").exists()


def test_a_missing_file_and_a_folder(run: Run, maps: dict[str, Path], tmp_path: Path) -> None:
    for path in (tmp_path / "nowhere.png", tmp_path):
        assert_one_line(run(*arguments({**maps, "height": path}, tmp_path / "out.png")), str(path))


def test_a_header_that_claims_too_many_pixels(run: Run, maps: dict[str, Path], tmp_path: Path) -> None:
    import struct
    import zlib

    header = struct.pack(">IIBBBBB", 2**15, 2**14, 8, 0, 0, 0, 0)
    chunk = struct.pack(">I", 13) + b"IHDR" + header + struct.pack(">I", zlib.crc32(b"IHDR" + header))
    maps["height"].write_bytes(b"\x89PNG\r\n\x1a\n" + chunk)
    assert_one_line(run(*arguments(maps, tmp_path / "out.png")), "height.png", "2^28")


@pytest.mark.parametrize(
    ("option", "value", "word"),
    [
        ("--size", "0x0", "0x0"),
        ("--size", "640", "WIDTHxHEIGHT"),
        ("--size", "99999x2", "65536"),
        ("--steps", "0", "linear_steps"),
        ("--steps", "many", "--steps"),
        ("--binary-steps", "-1", "binary_steps"),
        ("--binary-steps", "24", "2^24"),
        ("--delta", "nan", "steep_threshold"),
        ("--shadow-steps", "-3", "shadow_steps"),
        ("--height-scale", "0", "height_scale"),
        ("--height-scale", "-1", "height_scale"),
        ("--eye", "1,2", "'1,2'"),
        ("--eye", "0,0,0", "target"),
        ("--light", "0,0,0", "direction"),
        ("--fov", "180", "vertical_fov"),
        ("--method", "magic", "magic"),
        ("--lod-bias", "-1", "lod_bias"),
        ("--min-steps", "51", "min_steps"),
        ("--max-steps", "0", "max_steps"),
        ("--distance-layers", "1025", "distance_layers"),
        ("--interval", "half", "half"),
        ("--facade-tile", "0,1", "facade_tile"),
        ("--no-such-option", "1", "--no-such-option"),
    ],
)
def test_a_bad_option(run: Run, maps: dict[str, Path], tmp_path: Path, option: str, value: str, word: str) -> None:
    assert_one_line(run(*arguments(maps, tmp_path / "out.png", option, value)), word)
    assert not (tmp_path / "out.png").exists()


def test_volume_needs_auxiliary_faces(run: Run, maps: dict[str, Path], tmp_path: Path) -> None:
    result = run(*arguments(maps, tmp_path / "out.png", "--interval", "volume", "--faces", "base"))
    assert_one_line(result, "faces", "base", "auxiliary")


def test_an_extended_base_needs_an_eye_above(run: Run, maps: dict[str, Path], tmp_path: Path) -> None:
    result = run(*arguments(maps, tmp_path / "out.png", "--faces", "extended", "--eye", "0,-2,0.05"))
    assert_one_line(result, "faces", "extended")


@pytest.mark.parametrize("name", ["missing/out.png", "out.txt", "out"])
def test_unwritable_output(run: Run, maps: dict[str, Path], tmp_path: Path, name: str) -> None:
    assert_one_line(run(*arguments(maps, tmp_path / name)), str(tmp_path / name))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["color.png", "height.png"]


def test_bad_output_leaves_no_stages_behind(run: Run, maps: dict[str, Path], tmp_path: Path) -> None:
    assert_one_line(run(*arguments(maps, tmp_path / "out.txt", "--stages", tmp_path / "dump.npz")), "out.txt")
    assert not (tmp_path / "dump.npz").exists()


def test_no_height_at_all(run: Run, tmp_path: Path) -> None:
    assert_one_line(run("render", "displacement", "--out", tmp_path / "out.png"), "--height")


def test_unknown_command(run: Run) -> None:
    assert_one_line(run("paint"), "paint")


def test_an_error_in_a_pipe_is_one_line_too(tmp_path: Path) -> None:
    script = "from ibr_ref.cli import main; main()"
    command = ["render", "displacement", "--height", "nowhere.png", "--out", "out.png"]
    result = subprocess.run(
        [sys.executable, "-c", script, *command], capture_output=True, text=True, cwd=tmp_path, check=False
    )
    assert result.returncode == 2
    assert not result.stdout
    assert result.stderr.count("\n") == 1
    assert "nowhere.png" in result.stderr


@pytest.mark.long
def test_bench_writes_json(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from ibr_ref.bench import displacement

    scenes = displacement._scenes()
    monkeypatch.setattr(displacement, "_scenes", lambda: scenes[:1])
    code, out, err = run("bench", "displacement", "--repeat", "1", "--json", tmp_path / "times.json")
    assert (code, err) == (0, "")
    assert "6600GT" in out
    row = json.loads((tmp_path / "times.json").read_text())["displacement"][0]
    assert row["paper_ms"] == pytest.approx(1000 / 60)
    assert 0 < row["picture_best_ms"] <= row["picture_median_ms"]


@pytest.mark.long
def test_demo_makes_all_pictures(run: Run, tmp_path: Path) -> None:
    from ibr_ref import methods

    code, out, err = run("demo", "--out", tmp_path / "demo")
    assert (code, err) == (0, "")
    names = {path.stem for path in (tmp_path / "demo").iterdir()}
    assert names >= {f"figure_6{letter}" for letter in "abcdef"} | {"figure_15e", "city_shadows", "contact_sheet"}
    assert names >= {
        f"splat_figure_{figure}" for figure in ("1a", "1b", "3a", "3b", "3c", "5a", "5b", "6a", "6b", "6c")
    }
    assert len(names) == 1 + sum(method.demo.open().PICTURES for method in methods.records())
    for path in (tmp_path / "demo").glob("*figure*.png"):
        picture = imageio.imread(path)
        assert picture.shape == (480, 640, 3), path.name
        assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 3, f"{path.name} is blank"
    assert "ms" in out


REAL = Path(__file__).parents[2].parent / "shared" / "data" / "heightmaps"


@pytest.mark.skipif(not REAL.is_dir(), reason="the real height maps are not beside the repository (../shared/data)")
@pytest.mark.parametrize(
    "options",
    [
        ("--height", REAL / "toy_box_disp.png", "--invert-height", "--color", REAL / "toy_box_diffuse.png",
         "--normal", REAL / "toy_box_normal.png"),
        ("--height", REAL / "bricks2_disp.jpg", "--invert-height", "--color", REAL / "bricks2.jpg"),
        ("--height", REAL / "geneva_dsm_16bit.png"),
    ],
    ids=["toy_box", "bricks2", "geneva_dsm"],
)  # fmt: skip
def test_real_input(run: Run, tmp_path: Path, options: tuple[object, ...]) -> None:
    out, stages = tmp_path / "out.png", tmp_path / "dump.npz"
    command = ("render", "displacement", *options, "--size", "160x120", "--out", out, "--stages", stages)
    assert run(*command) == (0, "", "")
    with np.load(stages, allow_pickle=False) as dump:
        heights = dump["march.hit"][..., 2]
        assert np.nanmax(heights) > 0.5, "nothing stands out"
        assert (dump["march.hit_index"] >= 0).mean() > 0.2, "the map does not fill the picture"
