"""Ports that are programs: started for every case, told of one after another, or pages behind a door."""

from __future__ import annotations

import http.client
import json
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from ibr_ref.testing import Door, PortError, Program, Served, door, port_of, ports
from tests import browser
from tests.oracle.tiny_cases import TINY

LINES = """
import pathlib, sys
import numpy as np
COUNT = 0
for line in sys.stdin:
    case, out = map(pathlib.Path, line.rstrip("\\n").split("\\t"))
    if MODE == "refuse":
        print("no such\\tfeature", flush=True)
    elif MODE == "end":
        sys.exit(7)
    elif MODE == "silent":
        continue
    else:
        np.save(out / "depth.npy", np.load(case / "expected" / "depth.npy"))
        np.save(out / "color.npy", np.load(case / "expected" / "color.npy"))
        COUNT += 1
        (out / "count.txt").write_text(str(COUNT))
        print("ok", flush=True)
"""


def served(tmp_path: Path, mode: str) -> Served:
    (tmp_path / "port.py").write_text(f"MODE = {mode!r}\n{LINES}")
    return Served(f"{sys.executable} {tmp_path / 'port.py'}")


@pytest.fixture
def case_folder(tmp_path: Path) -> Path:
    from ibr_ref.oracle import export

    export(TINY["displacement-hill"](), tmp_path / "case")
    return tmp_path / "case"


def test_a_served_port_is_started_once(tmp_path: Path, case_folder: Path) -> None:
    port = served(tmp_path, "draw")
    for i in (1, 2):
        out = tmp_path / f"out {i}"
        out.mkdir()
        port.draw(case_folder, out)
        assert (out / "count.txt").read_text() == str(i)
    submission = port_of(port, TINY["displacement-hill"]())
    assert submission.usable
    assert set(submission.handed) == {"color", "depth"}
    port.close()


@pytest.mark.parametrize(
    ("mode", "says"), [("refuse", "no such feature"), ("end", "exit code 7"), ("silent", "no answer")]
)
def test_a_served_port_that_does_not_draw(
    tmp_path: Path, case_folder: Path, mode: str, says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ports, "LONGEST", 1.0 if mode == "silent" else 60.0)
    port = served(tmp_path, mode)
    for _ in range(2):  # it is started again
        with pytest.raises(PortError, match=says):
            port.draw(case_folder, tmp_path)
    port.close()


def test_what_is_no_program() -> None:
    with pytest.raises(ValueError, match="port: found '', allowed: a command"):
        Served("")
    with pytest.raises(OSError, match="/no/port: cannot be run"):
        Served("/no/port").draw(Path("a"), Path("b"))
    with pytest.raises(ValueError, match=r"\{case\} and \{out\}"):
        Program("./port {case}")


@pytest.fixture
def opened() -> Iterator[Door]:
    made = Door()
    yield made
    made.close()


def ask(opened: Door, method: str, place: str, body: bytes | None = None, host: str | None = None) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", opened.server.server_port, timeout=30)
    connection.request(method, place, body, {} if host is None else {"Host": host})
    answer = connection.getresponse()
    found = answer.status, answer.read()
    connection.close()
    return found


def test_a_door_hands_out_cases_and_takes_drawings(opened: Door, tmp_path: Path, case_folder: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    drawing = threading.Thread(target=opened.draw, args=(case_folder, out))
    drawing.start()
    at = f"/{opened.token}/"
    work = json.loads(ask(opened, "GET", at + "next")[1])
    assert work["number"] == 1
    assert "case.json" in work["files"]
    assert "expected/color.npy" in work["files"]
    assert ask(opened, "GET", at + "case/case.json")[1] == (case_folder / "case.json").read_bytes()
    color = (case_folder / "expected" / "color.npy").read_bytes()
    assert ask(opened, "POST", at + "drawn/1/color.npy", color)[0] == 204
    for place in ("drawn/1/../x", "drawn/1/.x", "drawn/1/a/b", "drawn/2/color.npy", "done/2", "done/1/x"):
        assert ask(opened, "POST", at + place, b"x")[0] == 404, place
    for place in ("case/../port.py", "case/", "case/none", "none"):
        assert ask(opened, "GET", at + place)[0] == 404, place
    assert ask(opened, "GET", "/next")[0] == 404
    assert ask(opened, "GET", at + "next", host="attacker.example")[0] == 404
    assert ask(opened, "POST", at + "done/1", b"ok")[0] == 204
    drawing.join(timeout=30)
    assert not drawing.is_alive()
    assert (out / "color.npy").read_bytes() == color
    assert sorted(path.name for path in out.iterdir()) == ["color.npy"]


def test_a_page_that_does_not_draw(
    opened: Door, tmp_path: Path, case_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(door, "COMING", 0.2)
    with pytest.raises(PortError, match="no answer within"):
        opened.draw(case_folder, tmp_path)


PAGE = """
<!doctype html><script type="module">
import { port } from "ADDRESSport.js";
document.body.dataset.ready = "yes";
let drawn = 0;
await port(async (read, files) => {
  if (drawn++ === 1) throw new Error("lost the context");
  return { "color.npy": await read(files.find((name) => name === "expected/color.npy")) };
});
document.body.dataset.over = "yes";
</script><body></body>
"""


@pytest.mark.skipif(browser.PROGRAM is None, reason=browser.MISSING)
def test_a_page_of_another_origin_is_a_port(tmp_path: Path) -> None:
    case = TINY["displacement-hill"]()
    opened = Door()
    (tmp_path / "page.html").write_text(PAGE.replace("ADDRESS", opened.address))
    with browser.browser(tmp_path / "profile") as page:
        page.open((tmp_path / "page.html").as_uri())
        submission = port_of(opened, case)
        assert np.array_equal(submission.handed["color"], case.frame.color)
        with pytest.raises(PortError, match="lost the context"):
            port_of(opened, case)
        assert port_of(opened, case).usable
        opened.close()
        page.wait("document.body.dataset.over === 'yes'")
