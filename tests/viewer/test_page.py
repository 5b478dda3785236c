"""The page in a browser, used as people use it."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from dataclasses import replace
from urllib.parse import unquote

import numpy as np
import pytest

from ibr_ref.displacement import render
from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.viewer import Server, Session
from tests import browser
from tests.browser import Page
from tests.viewer.subjects import block

pytestmark = pytest.mark.skipif(browser.PROGRAM is None, reason=browser.MISSING)

RESTED = "document.body.dataset.rested === 'yes'"


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    subject = block()
    drawing = {"color": 1.0 - render(subject.scene, subject.params).color}
    session = Session(replace(subject, drawing=drawing))
    session.start()
    session.difference({})  # kernels that have to be compiled take longer than a page is waited for
    with Server(session) as made:
        thread = threading.Thread(target=made.serve_forever)
        thread.start()
        yield made
        made.shutdown()
        thread.join()


@pytest.fixture(scope="module")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    with browser.browser(tmp_path_factory.mktemp("browser")) as page:
        yield page


@pytest.fixture
def page(server: Server, chromium: Page) -> Iterator[Page]:
    chromium.open(server.address)
    chromium.value("history.replaceState(null, '', location.pathname)")
    chromium.value("document.getElementById('reset').click()")
    chromium.mouse("mouseMoved", 1, 1)
    chromium.wait(RESTED)
    yield chromium
    assert chromium.faults == []


def shown(page: Page, canvas: str) -> np.ndarray:
    """(H, W, 3) of a canvas."""
    script = f"(c => Array.from(c.getContext('2d').getImageData(0, 0, c.width, c.height).data))({canvas})"
    width, height = page.value(f"[{canvas}.width, {canvas}.height]")
    return np.array(page.value(script), np.uint8).reshape(height, width, 4)[..., :3]


LEFT, RIGHT = "document.getElementById('left')", "document.getElementById('right')"


def state(page: Page) -> dict:
    return json.loads(unquote(page.value("location.hash.slice(1)")))


def choose(page: Page, which: str, value: str) -> None:
    page.value(f"(s => {{ s.value = {json.dumps(value)}; s.dispatchEvent(new Event('input')); }})({which})")
    page.wait(RESTED)


def test_it_opens_with_reference_and_drawing(server: Server, page: Page) -> None:
    frame = render(server.session.subject.scene, server.session.subject.params)
    assert np.array_equal(shown(page, LEFT), color_bytes(frame.color))
    assert np.array_equal(shown(page, RIGHT), color_bytes(1.0 - frame.color))
    assert (page.text("#left-name"), page.text("#right-name")) == ("reference", "port")
    assert "% of the pixels visibly differ from exact" in page.text("#status")
    assert page.text("#error") == ""
    _left, _top, width, height = page.box("#left")
    assert width / height == pytest.approx(48 / 36, rel=0.02)
    assert page.value("document.documentElement.scrollWidth <= innerWidth")


def test_a_drag_turns_what_is_seen_and_the_address_keeps_it(server: Server, page: Page) -> None:
    left, top, width, height = page.box("#view")
    page.drag((left + 0.3 * width, top + 0.5 * height), (left + 0.5 * width, top + 0.45 * height))
    page.wait(RESTED)
    kept = state(page)
    before, after = (np.array(c["eye"]) - c["target"] for c in (server.session.start()["camera"], kept["camera"]))
    assert np.linalg.norm(after) == pytest.approx(np.linalg.norm(before))
    assert np.linalg.norm(after - before) > 0.1 * np.linalg.norm(before)
    scene, params = server.session.described(kept)
    turned = shown(page, LEFT)
    assert np.array_equal(turned, color_bytes(render(scene, params).color))
    assert page.text("#right-name") == ""  # the port drew another view
    address = page.value("location.href")
    page.value("document.getElementById('reset').click()")
    page.wait(RESTED)
    assert not np.array_equal(shown(page, LEFT), turned)
    page.value(f"location.href = {json.dumps(address)}")
    page.wait("document.body.dataset.rested === 'no'")
    page.wait(RESTED)
    assert np.array_equal(shown(page, LEFT), turned)


def test_wheel_and_pan(server: Server, page: Page) -> None:
    left, top, width, height = page.box("#view")
    place = (left + 0.3 * width, top + 0.5 * height)
    page.mouse("mouseWheel", *place, deltaX=0, deltaY=-240)
    page.wait(RESTED)
    first, near = server.session.start()["camera"], state(page)["camera"]
    reach = [np.linalg.norm(np.subtract(c["eye"], c["target"])) for c in (first, near)]
    assert reach[1] == pytest.approx(reach[0] * np.exp(-0.24))
    page.drag(place, (place[0] + 40, place[1]), modifiers=8)
    page.wait(RESTED)
    panned = state(page)["camera"]
    moved = np.subtract(panned["eye"], near["eye"])
    assert np.allclose(moved, np.subtract(panned["target"], near["target"]))
    assert np.linalg.norm(moved) > 0.01


def test_sliders_and_systems_side_by_side(server: Server, page: Page) -> None:
    slider = "document.querySelector('[data-knob=linear_steps] input')"
    choose(page, "document.getElementById('other')", "method=exact")
    page.value(f"(s => {{ s.value = 0; s.dispatchEvent(new Event('input')); }})({slider})")
    page.wait("document.body.dataset.rested === 'yes'")
    assert state(page)["params"] == {"linear_steps": 1}
    subject = server.session.subject
    few = render(subject.scene, replace(subject.params, linear_steps=1))
    exact = render(subject.scene, replace(subject.params, linear_steps=1, method="exact"))
    assert np.array_equal(shown(page, LEFT), color_bytes(few.color))
    assert np.array_equal(shown(page, RIGHT), color_bytes(exact.color))
    assert (page.text("#left-name"), page.text("#right-name")) == ("protruded", "exact")
    left, top, width, _height = page.box("#view")
    page.drag((left + 0.7 * width, top + 20), (left + 0.25 * width, top + 20))
    assert page.value("document.getElementById('right').style.clipPath").startswith("inset(0px 0px 0px 2")
    assert page.value("document.querySelector('[data-knob=max_steps]').classList.contains('unread')")


def test_a_stage_and_the_numbers_of_a_pixel(server: Server, page: Page) -> None:
    choose(page, "document.getElementById('show')", "march.hit_index")
    assert "violet" in page.text("#status")
    assert page.text("#right-name") == ""  # the port handed in its colours alone
    left, top, width, height = page.box("#view")
    page.mouse("mouseMoved", left + (20.5 / 48) * width, top + (15.5 / 36) * height)
    page.wait("document.querySelectorAll('#numbers tbody tr').length > 10")
    assert "(20, 15)" in page.text("#numbers caption")
    frame = render(server.session.subject.scene, server.session.subject.params)
    cells = "[r.cells[0].textContent, r.cells[1].textContent]"
    rows = dict(page.value(f"Array.from(document.querySelectorAll('#numbers tbody tr'), r => {cells})"))
    assert rows["march.hit_index"] == str(frame.stages["march.hit_index"][15, 20])
    assert float(rows["depth"]) == pytest.approx(frame.depth[15, 20], rel=1e-8)


def test_what_may_not_be_is_said_and_mended(page: Page) -> None:
    box = "document.querySelector('[data-knob=linear_steps] input[type=number]')"
    for text, said in (("0", "linear_steps: found 0, allowed: a whole number from 1 to 16777216"), ("12", "")):
        page.value(f"(b => {{ b.value = '{text}'; b.dispatchEvent(new Event('change')); }})({box})")
        page.wait(f"document.getElementById('error').textContent === {json.dumps(said)}")
    page.wait(RESTED)
    page.faults[:] = [fault for fault in page.faults if "400" not in fault]  # the browser's own line about the refusal


def test_a_narrow_window_has_everything_below_each_other(server: Server, page: Page) -> None:
    page.open(server.address, (420, 800))
    page.wait(RESTED)
    assert page.value("document.documentElement.scrollWidth <= innerWidth")
    assert page.box("aside")[1] > page.box("#view")[1] + page.box("#view")[3]
