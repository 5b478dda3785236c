"""The WebGL ports on a page in a headless browser, judged by the oracle: 4 subpixel bits, as SwiftShader has them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from ibr_ref import oracle
from ibr_ref.oracle import Outcome


@pytest.fixture(scope="module")
def drawer() -> Iterator[Any]:
    from ibr_ref.ports.drawing import SAMPLES

    try:
        found = SAMPLES["webgl"](None)
    except ValueError as error:
        pytest.skip(str(error))
    yield found
    found.close()


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    "name",
    [
        "displacement-box",
        "displacement-parallax",
        "splatting-lamp",
        "splatting-discs",
        "splatting-ellipses",
        "splatting-ovals",
        "shadows-pace",
        "shadows-nearest",
        "shadows-penumbra",
    ],
)
def test_the_port_passes(name: str, drawer: Any, tmp_path: Path) -> None:
    """As it declares itself, from the case's folder alone, with all stages."""
    case = oracle.build(name)
    oracle.export(case, tmp_path / "case")
    drawer.into(tmp_path / "case", tmp_path / "drawn")
    submission = oracle.load_submission(tmp_path / "drawn", case)
    assert submission.declaration.profile == "gl"
    assert submission.declaration.numbers.keys() == {"subpixel_bits"}
    verdict = oracle.check(case, submission).verdict
    assert verdict.outcome is Outcome.PASS, verdict.words()
    assert len(verdict.stages) >= 4, "hardly a stage was handed in: the test says little"


def test_what_is_not_ported_is_refused_in_a_line(drawer: Any, tmp_path: Path) -> None:
    """And the browser goes on with the next case."""
    oracle.export(oracle.build("shadows-box"), tmp_path / "case")
    document = tmp_path / "case" / "case.json"
    text = document.read_text("utf-8")
    document.write_text(text.replace('"method": "warp"', '"method": "traced"'), "utf-8")
    with pytest.raises(
        ValueError, match=r"is not ported: method = 'traced': the port allows warp, direct, grid, pcss$"
    ):
        drawer.into(tmp_path / "case", tmp_path / "drawn")
    assert not (tmp_path / "drawn").exists()
    document.write_text(text, "utf-8")
    drawer.into(tmp_path / "case", tmp_path / "drawn")


def test_a_browser_that_is_none() -> None:
    from ibr_ref.ports.drawing import SAMPLES

    with pytest.raises(ValueError, match=r"^no WebGL 2: "):
        SAMPLES["webgl"]("true")
