"""`ibr-ref render shadows` and `ibr-ref bench shadows`."""

from __future__ import annotations

import json
from pathlib import Path

import imageio.v3 as imageio
import numpy as np
import pytest

from ibr_ref import io, metrics, models, shadows
from ibr_ref.bench import shadows as bench
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line

REAL = Path(__file__).parents[2].parent / "shared" / "data" / "models"


def of_cube(cube: Path, out: Path, *more: object) -> tuple[object, ...]:
    method = more[more.index("--method") + 1] if "--method" in more else "warp"
    small = ("--size", "96x72") if method == "traced" else ("--map-size", 64, "--size", "96x72")
    grids = ("--rows", 5, "--columns", 4) if method == "warp" else ()
    return ("render", "shadows", "--caster", cube, *small, *grids, "--out", out, *more)


@pytest.mark.parametrize("method", ["warp", "direct"])
def test_a_cube_casts_a_shadow(run: Run, cube: Path, tmp_path: Path, method: str) -> None:
    out, stages = tmp_path / "out.png", tmp_path / "dump.npz"
    assert run(*of_cube(cube, out, "--method", method, "--samples", 5, "--stages", stages)) == (0, "", "")
    picture = imageio.imread(out)
    assert picture.shape == (72, 96, 3)
    with np.load(stages, allow_pickle=False) as dump:
        shadow = dump["accumulate.shadow"]
        assert dump["warp.image"].shape == (5, 64, 64)
        assert np.array_equal(np.floor(np.clip(dump["color"], 0, 1) * 255 + 0.5), picture)
    assert 0.005 < (shadow > 0.5).mean() < 0.3
    assert ((shadow > 0.1) & (shadow < 0.9)).any(), "a soft shadow has a soft edge"


def test_prepared_maps_are_written_once_and_read_again(run: Run, cube: Path, tmp_path: Path) -> None:
    out, maps = tmp_path / "out.png", tmp_path / "maps.npz"
    assert run(*of_cube(cube, out, "--maps", maps)) == (0, "", "")
    before, first = maps.read_bytes(), out.read_bytes()
    assert run(*of_cube(cube, out, "--maps", maps)) == (0, "", "")
    assert maps.read_bytes() == before
    assert out.read_bytes() == first
    for option, value, words in (
        ("--rows", 6, ("--rows", "5", "6")),
        ("--columns", 5, ("--columns", "4", "5")),
        ("--map-size", 128, ("--map-size", "64", "128")),
        ("--map-samples", 2, ("--map-samples", "1", "2")),
        ("--content", "depth", ("--content", "mask", "depth")),
        ("--controls", "best", ("--controls", "fast", "best")),
    ):
        assert_one_line(run(*of_cube(cube, out, "--maps", maps, option, value)), *words, "maps.npz")
    assert run(*of_cube(cube, out, "--maps", maps, "--controls", "fast")) == (0, "", "")
    plain = ("render", "shadows", "--caster", cube, "--size", "96x72", "--out", out, "--maps", maps)
    assert run(*plain) == (0, "", ""), "what is not given is the file's"
    assert out.read_bytes() == first


def test_the_report(run: Run, cube: Path, tmp_path: Path) -> None:
    code, out, err = run(*of_cube(cube, tmp_path / "out.png", "--report"))
    assert (code, err) == (0, "")
    for word in ("bytes", "IoU", "mean difference", "control points: ", "at 32 other places", "not taken: ", "bounds"):
        assert word in out
    code, out, err = run(*of_cube(cube, tmp_path / "out.png", "--report", "--controls", "bounds"))
    assert (code, err) == (0, "")
    assert "not compared" in out


def test_the_projective_pace(run: Run, cube: Path, tmp_path: Path) -> None:
    out, stages, maps = tmp_path / "out.png", tmp_path / "dump.npz", tmp_path / "maps.npz"
    more = ("--maps", maps, "--interpolation", "projective", "--offset", "0.3,-0.2")
    assert run(*of_cube(cube, out, *more, "--stages", stages)) == (0, "", "")
    with np.load(stages, allow_pickle=False) as dump:
        assert dump["warp.shares"].shape == (3,)
        assert dump["maps.depths"].shape == (3, 3)
    code, said, err = run(*of_cube(cube, out, "--maps", maps, "--report"))
    assert (code, err) == (0, "")
    assert "chosen for interpolation projective, not linear" in said


def test_that_no_good_control_points_were_found_is_said(run: Run, tmp_path: Path) -> None:
    """A bar so thin that hardly a texel's centre is in its shadow."""
    path = tmp_path / "bar.obj"
    path.write_text("v 0 0 0\nv 5 0 3\nv 5 .02 3.02\nv 0 .02 .02\nf 1 2 3\nf 1 3 4\n")
    code, out, err = run(*of_cube(path, tmp_path / "out.png", "--map-size", 32))
    assert (code, out) == (0, "")
    assert err.startswith("no good control points were found: ")
    assert err.count("\n") == 1


@pytest.mark.parametrize("method", ["traced", "convolution", "pcss"])
def test_the_whole_light(run: Run, cube: Path, tmp_path: Path, method: str) -> None:
    out, stages = tmp_path / "out.png", tmp_path / "dump.npz"
    code, said, err = run(*of_cube(cube, out, "--method", method, "--stages", stages, "--report"))
    assert (code, err) == (0, "")
    assert float(said.split("difference")[1]) < 0.05
    with np.load(stages, allow_pickle=False) as dump:
        shadow = dump["accumulate.shadow" if method == "pcss" else "soft.shadow"]
    assert ((shadow > 0.1) & (shadow < 0.9)).any()
    assert imageio.imread(out).shape == (72, 96, 3)
    assert_one_line(run(*of_cube(cube, out, "--method", method, "--maps", tmp_path / "m.npz")), "--maps", "warp")


def test_a_mesh_of_y_up_stands(run: Run, tmp_path: Path) -> None:
    """A pole along y: upright as OBJ, lying as it is where z is said to be up."""
    path = tmp_path / "pole.obj"
    path.write_text("v 0 0 0\nv .1 0 0\nv .1 5 0\nv 0 5 0\nf 1 2 3\nf 1 3 4\n")
    pictures = []
    for more in ((), ("--up", "y"), ("--up", "z")):
        assert run(*of_cube(path, tmp_path / "out.png", "--method", "direct", *more)) == (0, "", "")
        pictures.append(imageio.imread(tmp_path / "out.png"))
    assert np.array_equal(pictures[0], pictures[1])
    assert not np.array_equal(pictures[0], pictures[2])


def test_a_light_that_is_placed(run: Run, cube: Path, tmp_path: Path) -> None:
    """What is drawn is the stage with that light."""
    out = tmp_path / "out.png"
    placed = ("--method", "direct", "--light", "2,1,4", "--light-target", "0,0.1,0", "--light-size", "0.3,0.1")
    assert run(*of_cube(cube, out, *placed, "--samples", 5)) == (0, "", "")
    scene = models.shadow_stage(
        io.read_upright(cube),
        light_position=(2, 1, 4),
        light_target=(0, 0.1, 0),
        light_size=(0.3, 0.1),
        width=96,
        height=72,
    )
    frame = shadows.render(scene, shadows.Params(method="direct", map_size=64, light_samples=5))
    assert np.array_equal(io.read_image(out), np.floor(frame.color * 255 + 0.5) / 255)
    assert 0.005 < (frame.stages["accumulate.shadow"] > 0.5).mean() < 0.3


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--light", "0,0,0", "--light-target", "0,0,-0.5"), ("light_position: found [0.0, 0.0, 0.0]",)),
        (("--light", "0,0,0"), ("light_target",)),
        (("--light", "0,1"), ("--light", "'0,1'", "3 numbers")),
        (("--light-size", "0.1,-1", "--samples", "5"), ("light_size: found [0.1, -1.0]",)),
        (("--offset", "0.7,0"), ("offset", "-0.6", "0.6")),
        (("--offset", "0"), ("'0'", "2 numbers")),
        (("--samples", "4"), ("light_samples", "1, 5, 9")),
        (("--map-size", "4"), ("map_size",)),
        (("--rows", "1"), ("rows",)),
        (("--light-size", "-1", "--samples", "5"), ("light_size",)),
        (("--controls", "worst"), ("worst",)),
        (("--method", "magic"), ("magic",)),
        (("--method", "direct", "--maps", "m.npz"), ("--maps", "--method")),
        (("--size", "0x0"), ("0x0",)),
    ],
)
def test_a_bad_option(run: Run, cube: Path, tmp_path: Path, more: tuple[str, ...], words: tuple[str, ...]) -> None:
    assert_one_line(run(*of_cube(cube, tmp_path / "out.png", *more)), *words)
    assert not (tmp_path / "out.png").exists()


@pytest.mark.parametrize(
    "text", ["", "not a mesh", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "v 0 0 0\nf 1 1 1\n"], ids=lambda t: t[:8]
)
def test_a_bad_mesh(run: Run, tmp_path: Path, text: str) -> None:
    path = tmp_path / "bad.obj"
    path.write_text(text)
    assert run(*of_cube(path, tmp_path / "out.png"))[0] == 2
    assert not (tmp_path / "out.png").exists()


def test_maps_that_are_none(run: Run, cube: Path, tmp_path: Path) -> None:
    for content in (b"", b"no archive"):
        (tmp_path / "maps.npz").write_bytes(content)
        assert_one_line(run(*of_cube(cube, tmp_path / "out.png", "--maps", tmp_path / "maps.npz")), "maps.npz")


def test_quality_by_hand() -> None:
    ours, theirs = np.array([[1.0, 1.0, 0.0, 0.25]]), np.array([[1.0, 0.0, 0.0, 0.0]])
    assert metrics.iou(ours, theirs) == 0.5
    assert metrics.iou(0.0 * ours, 0.0 * ours) == 1.0
    assert metrics.soft_difference(ours, theirs) == pytest.approx(1.25 / 3)
    assert metrics.soft_difference(0.0 * ours, 0.0 * ours) == 0.0


@pytest.mark.long
def test_bench_writes_json(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "SIZES", (64,))
    code, out, err = run("bench", "shadows", "--repeat", "1", "--json", tmp_path / "times.json")
    assert (code, err) == (0, "")
    rows = json.loads((tmp_path / "times.json").read_text())["shadows"]
    assert {row["way"] for row in rows} >= set(bench.PAPER_KETTLE)
    assert all(0 < row["best_ms"] <= row["median_ms"] for row in rows)
    assert {row["object"] for row in rows} == set(bench.PAPER_WARP)
    assert "tables 1 to 5" in " ".join(out.split())


@pytest.mark.skipif(not (REAL / "cow.obj").exists(), reason="the cow is not beside the repository (../shared/data)")
def test_the_cow(run: Run, tmp_path: Path) -> None:
    """What the issue of this method ends with."""
    out = tmp_path / "cow.png"
    assert run("render", "shadows", "--caster", REAL / "cow.obj", "--samples", "9", "--out", out) == (0, "", "")
    assert imageio.imread(out).shape == (480, 640, 3)


TWO = ("--offset=-0.6,0", "--offset", "0.6,0.3", "--light=-1,-1.2,5", "--light", "2,-1,4")


def test_two_casters_under_two_lights(run: Run, cube: Path, tmp_path: Path) -> None:
    """What is drawn is that ensemble; of powers and sizes one stands for all."""
    out, stages = tmp_path / "out.png", tmp_path / "dump.npz"
    more = ("--caster", cube, *TWO, "--light-power", "0.4", "--light-size", "0.2", "--samples", 5, "--method", "direct")
    code, said, err = run(*of_cube(cube, out, *more, "--report", "--stages", stages))
    assert (code, err) == (0, "")
    assert said.count("shadow of light ") == 2
    assert "IoU 1.000" in said
    ensemble = models.shadow_ensemble(
        [io.read_upright(cube)] * 2,
        offsets=[(-0.6, 0), (0.6, 0.3)],
        lights=[models.StageLight(position=at, size=0.2, power=0.4) for at in ((-1, -1.2, 5), (2, -1, 4))],
        width=96,
        height=72,
    )
    frame = shadows.render_ensemble(ensemble, shadows.Params(method="direct", map_size=64, light_samples=5))
    assert np.array_equal(io.read_image(out), np.floor(frame.color * 255 + 0.5) / 255)
    with np.load(stages, allow_pickle=False) as dump:
        assert dump["light1.caster1.warp.image"].shape == (5, 64, 64)
        assert np.array_equal(dump["light1.accumulate.shadow"], frame.stages["light1.accumulate.shadow"])


def test_what_is_cut_is_said_of_each_caster_and_light(run: Run, cube: Path, tmp_path: Path) -> None:
    more = ("--caster", cube, *TWO[:3], "--method", "direct", "--samples", 9, "--light-size", 3)
    code, _, err = run(*of_cube(cube, tmp_path / "out.png", *more))
    assert code == 0
    assert [line.split(": ")[1] for line in err.splitlines()] == ["casters[0]", "casters[1]"]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--offset", "0,0", "--offset", "0,0"), ("--offset: found 2", "each of 1 of --caster")),
        (("--caster", "CUBE"), ("--offset: found 0", "each of 2 of --caster")),
        (("--light", "0,0,5", "--light", "1,0,5", *["--light-target", "0,0,0"] * 3), ("--light-target: found 3",)),
        (("--light", "0,0,5", "--light-power", "-1"), ("powers[0]: found -1.0",)),
        (
            ("--light", "0,0,5", "--light", "1,0,5", "--method", "pcss"),
            ("--method pcss", "2 of --light", "one of each"),
        ),
        (("--light", "0,0,5", "--light", "1,0,5", "--case", "box"), ("--case", "the oracle judges no others")),
        (("--light", "0,0,5", "--light", "1,0,5", "--maps", "m.npz"), ("--maps", "one caster and one light")),
        (("--light-power", "0.5", "--case", "box"), ("--case", "without --light-power")),
    ],
    ids=lambda value: " ".join(value),
)
def test_several_that_do_not_go_together(
    run: Run, cube: Path, tmp_path: Path, more: tuple[str, ...], words: tuple[str, ...]
) -> None:
    given = [cube if word == "CUBE" else word for word in more]
    assert_one_line(run(*of_cube(cube, tmp_path / "out.png", *given)), *words)
    assert not (tmp_path / "out.png").exists()
