"""Unusable and dishonest submissions: each gets the right answer, and none a traceback or a PASS."""

from __future__ import annotations

import json
import os
import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.ndimage import gaussian_filter, zoom

from ibr_ref import oracle
from ibr_ref.oracle import Case
from ibr_ref.oracle.findings import Outcome

CASE, OTHER, SAME_SIZE = "splatting-lamp", "splatting-ball", "splatting-shelves"
Maker = Callable[[Path, Case], None]
SABOTAGE: dict[str, tuple[Outcome, str, Maker]] = {}
"""By name: the right outcome, what the words must say, and what writes the submission."""


def submission(name: str, outcome: Outcome, words: str) -> Callable[[Maker], Maker]:
    def entered(maker: Maker) -> Maker:
        SABOTAGE[name] = outcome, words, maker
        return maker

    return entered


def picture(name: str, outcome: Outcome, words: str) -> Callable[[Callable[[np.ndarray], np.ndarray]], None]:
    """A submission of a colour alone, made of the expected one (H, W, 3) in [0, 1]."""

    def entered(change: Callable[[np.ndarray], np.ndarray]) -> None:
        SABOTAGE[name] = outcome, words, lambda folder, case: np.save(folder / "color.npy", change(case.frame.color))

    return entered


def bytes_of(color: np.ndarray) -> np.ndarray:
    return np.floor(255.0 * np.clip(color, 0.0, 1.0) + 0.5).astype(np.uint8)


INCONCLUSIVE, FAIL = Outcome.INCONCLUSIVE, Outcome.FAIL

picture("black", INCONCLUSIVE, "nothing rendered")(np.zeros_like)
picture("white", INCONCLUSIVE, "nothing rendered")(np.ones_like)
picture("background alone", INCONCLUSIVE, "the background")(lambda c: np.broadcast_to((0.2, 0.4, 0.71), c.shape).copy())
picture("all NaN", INCONCLUSIVE, "nan")(lambda c: np.full_like(c, np.nan))
picture("one NaN", INCONCLUSIVE, "nan")(lambda c: np.where(np.arange(c.size).reshape(c.shape) == 5000, np.nan, c))
picture("one infinity", INCONCLUSIVE, "inf")(lambda c: np.where(np.arange(c.size).reshape(c.shape) == 5000, np.inf, c))
picture("floats from 0 to 255", INCONCLUSIVE, "bytes as uint8")(lambda c: 255.0 * c)
picture("wrong size", INCONCLUSIVE, "color.npy")(lambda c: c[:-1])
picture("rows and columns exchanged", INCONCLUSIVE, "color.npy")(lambda c: c.swapaxes(0, 1).copy())
picture("grey", INCONCLUSIVE, "color.npy")(lambda c: c.mean(axis=-1))
picture("words for numbers", INCONCLUSIVE, "color.npy")(lambda c: c.astype("U8"))
picture("complex numbers", INCONCLUSIVE, "color.npy")(lambda c: c.astype(complex))
picture("big-endian", INCONCLUSIVE, "color.npy")(lambda c: c.astype(">f8"))
picture("flipped rows", FAIL, "rows from the bottom up would explain all of it")(lambda c: c[::-1].copy())
picture("BGR", FAIL, "channels in the order BGR would explain all of it")(lambda c: c[..., ::-1].copy())
picture("sRGB", FAIL, "colours encoded as sRGB would explain all of it")(
    lambda c: np.where(c <= 0.0031308, 12.92 * c, 1.055 * np.maximum(c, 1e-9) ** (1 / 2.4) - 0.055)
)
picture("blurred", FAIL, "first wrong in stage image")(lambda c: gaussian_filter(c, (0.7, 0.7, 0)))
picture("half as many pixels, enlarged", FAIL, "first wrong in stage image")(
    lambda c: zoom(c[::2, ::2], (2, 2, 1), order=1)[: c.shape[0], : c.shape[1]]
)
picture("six bits a channel", FAIL, "first wrong in stage image")(lambda c: np.floor(63 * c + 0.5) / 63)
picture("noise of half a byte", FAIL, "first wrong in stage image")(
    lambda c: np.clip(c + np.random.default_rng(0).uniform(-0.5, 0.5, c.shape) / 255, 0, 1)
)
picture("one pixel retouched", FAIL, "first wrong in stage image")(
    lambda c: np.where(np.arange(c.size).reshape(c.shape) // 3 == 84 * 112 // 2 + 56, 1 - c, c)
)


@submission("nothing at all", INCONCLUSIVE, "neither a final image nor a stage")
def _(folder: Path, case: Case) -> None:
    pass


@submission("depth alone", INCONCLUSIVE, "neither a final image nor a stage")
def _(folder: Path, case: Case) -> None:
    np.save(folder / "depth.npy", case.frame.depth)


@submission("a truncated array", INCONCLUSIVE, "color.npy")
def _(folder: Path, case: Case) -> None:
    np.save(folder / "color.npy", case.frame.color)
    data = (folder / "color.npy").read_bytes()
    (folder / "color.npy").write_bytes(data[: len(data) // 2])


@submission("a truncated picture", INCONCLUSIVE, "color.png")
def _(folder: Path, case: Case) -> None:
    Image.fromarray(bytes_of(case.frame.color)).save(folder / "color.png")
    data = (folder / "color.png").read_bytes()
    (folder / "color.png").write_bytes(data[: len(data) // 2])


@submission("a pickle under an array's name", INCONCLUSIVE, "color.npy")
def _(folder: Path, case: Case) -> None:
    (folder / "color.npy").write_bytes(pickle.dumps(case.frame.color))


@submission("an object array", INCONCLUSIVE, "color.npy")
def _(folder: Path, case: Case) -> None:
    np.save(folder / "color.npy", case.frame.color.astype(object), allow_pickle=True)


@submission("a header that claims 10 GB", INCONCLUSIVE, "color.npy")
def _(folder: Path, case: Case) -> None:
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (20000, 20000, 3), }"
    header += b" " * (118 - len(header) - 1) + b"\n"
    (folder / "color.npy").write_bytes(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header)


@submission("two images that contradict each other", INCONCLUSIVE, "a second color")
def _(folder: Path, case: Case) -> None:
    np.save(folder / "color.npy", case.frame.color)
    Image.fromarray(bytes_of(case.frame.color[::-1])).save(folder / "color.png")


@submission("a link out of the folder", INCONCLUSIVE, "color.npy")
def _(folder: Path, case: Case) -> None:
    outside = folder.parent / "expected.npy"
    np.save(outside, case.frame.color)
    os.symlink(outside, folder / "color.npy")


@submission("a profile that does not exist", INCONCLUSIVE, "port.json")
def _(folder: Path, case: Case) -> None:
    np.save(folder / "color.npy", case.frame.color)
    (folder / "port.json").write_text(json.dumps({"profile": "anything goes"}))


@submission("z in [-1, 1]", FAIL, "depth as z in [-1, 1] would explain all of it")
def _(folder: Path, case: Case) -> None:
    np.save(folder / "color.npy", case.frame.color)
    np.save(folder / "depth.npy", 2.0 * case.frame.depth - 1.0)


@submission("the expected image with winners moved by a row", FAIL, "first wrong in stage raster")
def _(folder: Path, case: Case) -> None:
    np.save(folder / "color.npy", case.frame.color)
    for name in ("raster.depth", "raster.overdraw", *(f"vertex.{x}" for x in ("window", "depth", "width", "color"))):
        np.save(folder / f"{name}.npy", case.frame.stages[name])
    np.save(folder / "raster.splat.npy", np.roll(case.frame.stages["raster.splat"], 1, 0))


@submission("the expected stages under a wrong image", FAIL, "first wrong in stage resolve")
def _(folder: Path, case: Case) -> None:
    np.save(folder / "color.npy", gaussian_filter(case.frame.color, (0.7, 0.7, 0)))
    for name, array in case.frame.stages.items():
        if not isinstance(array, tuple) and name.split(".")[0] in ("vertex", "raster"):
            np.save(folder / f"{name}.npy", array)


@submission("another case's stages", INCONCLUSIVE, "vertex.window.npy")
def _(folder: Path, case: Case) -> None:
    np.save(folder / "color.npy", case.frame.color)
    np.save(folder / "vertex.window.npy", oracle.build(OTHER).frame.stages["vertex.window"])


def test_there_are_enough_of_them() -> None:
    assert len(SABOTAGE) >= 25


@pytest.fixture(scope="module")
def case() -> Case:
    return oracle.build(CASE)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", SABOTAGE)
def test_the_right_answer(name: str, case: Case, tmp_path: Path) -> None:
    outcome, words, make = SABOTAGE[name]
    folder = tmp_path / "port"
    folder.mkdir()
    make(folder, case)
    verdict = oracle.check(case, oracle.load_submission(folder, case)).verdict
    assert verdict.outcome is outcome, verdict.words()
    assert words in verdict.words()


def test_another_cases_image_is_stale(tmp_path: Path) -> None:
    np.save(tmp_path / "color.npy", oracle.build(SAME_SIZE).frame.color)
    other = oracle.build(OTHER)
    verdict = oracle.check(other, oracle.load_submission(tmp_path, other)).verdict
    assert verdict.outcome is INCONCLUSIVE, verdict.words()
    assert f"the image of another case, '{SAME_SIZE}'" in verdict.words()


def test_the_honest_one_passes(case: Case, tmp_path: Path) -> None:
    Image.fromarray(bytes_of(case.frame.color)).save(tmp_path / "color.png")
    assert oracle.check(case, oracle.load_submission(tmp_path, case)).verdict.outcome is Outcome.PASS
