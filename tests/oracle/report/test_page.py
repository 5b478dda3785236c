"""The report: one file that needs nothing else, and what a browser makes of it."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from ibr_ref.oracle import report
from ibr_ref.oracle.examination import Examination, examine
from tests.oracle.plain_referee import box_case, judges_all

BROWSER = next(
    (path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), None
)


@pytest.fixture(scope="module")
def failed() -> Examination:
    """A port whose search goes wrong in a square."""
    patch = pytest.MonkeyPatch()
    judges_all(patch)
    case = box_case()
    frame = case.frame
    handed = {"color": np.floor(255 * frame.color + 0.5).astype(np.uint8)}
    handed |= {name: array.copy() for name, array in frame.stages.items() if name.startswith(("raster", "march"))}
    handed["march.hit_index"][30:42, 40:60] += 1
    handed["color"][30:42, 40:60] = (255, 0, 255)
    examination = examine(case, handed)
    patch.undo()
    return examination


def test_the_page_is_self_contained(failed: Examination) -> None:
    text = report.page(failed)
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:)""", text)
    assert not re.search(r"https?://|url\(|@import", text)
    assert "default-src 'none'" in text
    assert text.count("data:image/png;base64,") == 5  # reference, port, difference, marks, the stage
    for part in ("FAIL", "march.hit_index in 240", "Witness: pixel", "h &lt; H"):
        assert part in text


def test_markup_in_names_is_text(failed: Examination) -> None:
    """A case's words and a port's names may hold anything."""
    import dataclasses

    case = dataclasses.replace(failed.case, about="</script><script>alert(1)</script>")
    handed = {**failed.handed, "march.</script>": failed.handed["march.steep"]}
    text = report.page(dataclasses.replace(failed, case=case, handed=handed))
    assert "<script>alert" not in text
    assert text.count("</script>") == 2


def test_the_file_is_written_whole_or_not_at_all(failed: Examination, tmp_path: Path) -> None:
    report.write(failed, tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text("utf-8") == report.page(failed)
    with pytest.raises(FileNotFoundError, match="does not exist"):
        report.write(failed, tmp_path / "no" / "report.html")
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


@pytest.fixture(scope="module")
def browser(failed: Examination, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., str]:
    """Run headless Chromium on the page; the result is what it prints."""
    if BROWSER is None:
        pytest.skip("no Chromium: Debian's package chromium has one")
    folder = tmp_path_factory.mktemp("browser")
    report.write(failed, folder / "report.html")

    def run(place: str, *options: str) -> str:
        command = [
            BROWSER,
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--hide-scrollbars",
            "--virtual-time-budget=8000",
        ]
        command += [f"--user-data-dir={folder / 'profile'}", *options, f"file://{folder / 'report.html'}#{place}"]
        return subprocess.run(command, check=True, capture_output=True, text=True, timeout=120).stdout

    return run


def values(dom: str) -> dict[str, tuple[str, str]]:
    """The inspector's rows."""
    body = dom[dom.index('id="values"') :]
    rows = re.findall(r"<tr[^>]*><td>(.*?)</td><td>(.*?)</td><td>(.*?)</td></tr>", body[: body.index("</tbody>")])
    return {name: (unescape(ours), unescape(theirs)) for name, ours, theirs in rows}


def red(dom: str) -> list[str]:
    """Arrays that the inspector calls wrong."""
    return sorted(
        re.findall(r'<tr class="wrong"><td>(.*?)</td>', dom[dom.index('id="values"') :].partition("</tbody>")[0])
    )


def test_the_inspector_shows_reference_and_port(browser: Callable[..., str], failed: Examination) -> None:
    dom = browser("45,33", "--dump-dom")
    assert 'data-ready="yes"' in dom
    assert re.search(r'id="place">45, 33<', dom)
    assert re.search(r'id="status">wrong<', dom)
    index = failed.case.frame.stages["march.hit_index"][33, 45]
    found = values(dom)
    assert found["march.hit_index"] == (str(index), str(index + 1))
    assert found["color"][1] == "1, 0, 1"
    assert found["shade.normal"][1] == ""
    assert found["raster.face"][0] == found["raster.face"][1]
    assert red(dom) == ["color", "march.hit_index"]
    assert red(browser("3,60", "--dump-dom")) == []
    assert re.search(r'id="status">undecided<', browser("45,1", "--dump-dom"))
    assert re.search(r'id="status">right<', browser("3,60", "--dump-dom"))


def test_the_page_opens_on_the_witness(browser: Callable[..., str], failed: Examination) -> None:
    row, column = failed.verdict.witness.index  # type: ignore[union-attr]
    assert re.search(rf'id="place">{column}, {row}<', browser("", "--dump-dom"))


def test_the_seam_divides_reference_from_port(browser: Callable[..., str], tmp_path: Path) -> None:
    """Magenta, which only the port has, is seen where the seam is left of it, and not where it is right of it."""
    shares = []
    for percent in (0, 100):
        picture = tmp_path / f"{percent}.png"
        browser(f"5,5,{percent}", f"--screenshot={picture}", "--window-size=1400,1100")
        pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
        viewer = pixels[:, : pixels.shape[1] // 2]
        shares.append(((viewer - (255, 0, 255)) ** 2).sum(axis=-1) < 1000)
    assert shares[0].sum() > 5_000
    assert shares[1].sum() < 0.01 * shares[0].sum()
