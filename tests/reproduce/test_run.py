"""Steps that are kept, pages that need nothing else."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from ibr_ref.io import write_image
from ibr_ref.progress import progress
from ibr_ref.reproduce.findings import Claim, Figure, Found, Reproduction, Step, Table, Within
from ibr_ref.reproduce.run import run


class Counted:
    """A paper of two steps that counts how often each is run."""

    def __init__(self) -> None:
        self.runs = {"numbers": 0, "picture": 0}
        self.broken = False

    def numbers(self, folder: Path, within: Within) -> Found:
        self.runs["numbers"] += 1
        within("measuring", 1, 2)
        table = Table(
            title="Table 1 <b>", columns=("object", "ms"), rows=(("box", 1.23456), ("city", None)), how="Once."
        )
        claim = Claim(claim="It is fast.", published="2 ms", measured="1 ms", holds=True)
        return Found(tables=(table,), claims=(claim,))

    def picture(self, folder: Path, within: Within) -> Found:
        self.runs["picture"] += 1
        if self.broken:
            raise KeyboardInterrupt
        write_image(folder / "grey.png", np.full((4, 6, 3), 0.5))
        return Found(figures=(Figure(title="Figure 3", file="grey.png", caption="Grey."),))

    def go(self, out: Path, *, again: bool = False) -> Path:
        steps = (
            Step(name="numbers", title="Numbers", run=self.numbers),
            Step(name="picture", title="A picture", run=self.picture),
        )
        reproduction = Reproduction(
            number=1, method="displacement", paper="A & B 2006", steps=steps, ambiguities=(("which?", "this"),)
        )
        with progress(2) as step:
            return run(reproduction, out, again=again, step=step)


def test_the_page_holds_everything(tmp_path: Path) -> None:
    page = Counted().go(tmp_path)
    text = page.read_text("utf-8")
    for part in (
        "A &amp; B 2006",
        "Table 1 &lt;b&gt;",
        "1.235",
        "–",
        "It is fast.",
        "data:image/png;base64,",
        "which?",
    ):
        assert part in text
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:)""", text)
    data = json.loads((page.parent / "page.json").read_text("utf-8"))
    assert data["steps"]["numbers"]["tables"][0]["rows"][0] == ["box", 1.23456]


def test_what_is_done_is_not_done_again(tmp_path: Path) -> None:
    paper = Counted()
    paper.broken = True
    with pytest.raises(KeyboardInterrupt):
        paper.go(tmp_path)
    assert not (tmp_path / "1-displacement" / "page.html").exists()
    paper.broken = False
    first = paper.go(tmp_path).read_bytes()
    assert paper.runs == {"numbers": 1, "picture": 2}
    assert paper.go(tmp_path).read_bytes() == first
    assert paper.runs == {"numbers": 1, "picture": 2}
    paper.go(tmp_path, again=True)
    assert paper.runs == {"numbers": 2, "picture": 3}


@pytest.mark.parametrize("name", ["found.json", "sources.txt"])
def test_a_damaged_or_outdated_step_is_run_again(tmp_path: Path, name: str) -> None:
    paper = Counted()
    paper.go(tmp_path)
    (tmp_path / "1-displacement" / "numbers" / name).write_text("{")
    paper.go(tmp_path)
    assert paper.runs == {"numbers": 2, "picture": 1}


def test_a_lost_picture_is_made_again(tmp_path: Path) -> None:
    paper = Counted()
    paper.go(tmp_path)
    (tmp_path / "1-displacement" / "picture" / "grey.png").unlink()
    paper.go(tmp_path)
    assert paper.runs == {"numbers": 1, "picture": 2}
