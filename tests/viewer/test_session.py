"""What pages are told: the renders themselves, of states that may be."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from ibr_ref import methods, oracle, viewer
from ibr_ref.displacement import bounding_points, render
from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.scene import Camera, checks
from ibr_ref.viewer import Session, Subject
from ibr_ref.viewer.pose import Pose
from tests.toy_method import RECORD
from tests.viewer.subjects import MOVED, SUBJECTS, block, wall


@pytest.fixture(scope="module")
def session() -> Session:
    return Session(block())


@pytest.mark.parametrize("name", SUBJECTS)
def test_a_page_opens_with_what_render_draws(name: str) -> None:
    """To the last bit: the camera is the scene's own until it is moved; so are the planes."""
    subject = SUBJECTS[name]()
    opened = Session(subject)
    start = json.loads(json.dumps(opened.start(), allow_nan=False))
    expected = methods.named(name).package.open().render(subject.scene, subject.params)
    picture, _ = opened.shown({"show": "color"})
    assert np.array_equal(picture.pixels[..., :3], color_bytes(expected.color))
    assert (picture.pixels[..., 3] == 255).all()
    assert start["size"] == [expected.depth.shape[1], expected.depth.shape[0]]
    turnable = {knob["name"] for knob in start["knobs"]["params"]}
    assert turnable == {field.name for field in fields(subject.params)}
    for show in start["shows"]:
        assert opened.shown({"show": show})[0].pixels.ndim == 3


def test_the_pose_of_a_camera_is_the_camera(session: Session) -> None:
    scene = session.subject.scene
    points = bounding_points(scene.polygons, scene.camera)
    pose = Pose.of(scene.camera, points)
    assert pose.up == (0.0, 0.0, 1.0)
    seen = pose.seen(scene.camera)
    assert np.allclose(seen.view_from_world, scene.camera.view_from_world, rtol=0, atol=1e-12)
    assert np.array_equal(seen.intrinsics, scene.camera.intrinsics)


def test_a_camera_that_no_axis_is_level_for_keeps_its_own_up() -> None:
    camera = Camera.look_at(eye=(1, 2, 3), target=(0, 0, 0), up=(1, 1, 0.3))
    pose = Pose.of(camera, np.zeros((1, 3)))
    assert np.allclose(pose.up, camera.world_from_view[:3, 1])


def test_zoom_scales_the_picture_of_parallel_rays() -> None:
    subject = wall()
    pose = Pose.of(subject.scene.camera, np.zeros((1, 3)))
    seen = replace(pose, zoom=2.0).seen(subject.scene.camera)
    assert np.array_equal(seen.clip_from_view[:2], 2.0 * subject.scene.camera.clip_from_view[:2])


def test_what_is_turned_is_drawn(session: Session) -> None:
    state = {"camera": MOVED, "params": {"linear_steps": 3}, "scene": {"height": 2.0, "ambient": 0.5}}
    scene, params = session.described(state)
    assert params.linear_steps == 3
    assert scene.polygons[0].height_scale == 2.0 * session.subject.scene.polygons[0].height_scale
    assert scene.light.ambient == 0.5
    assert scene.camera.eye[:3].tolist() == MOVED["eye"]
    drawn = render(scene, params)
    picture, _ = session.shown(state)
    assert np.array_equal(picture.pixels[..., :3], color_bytes(drawn.color))
    assert (drawn.depth < 1.0).any()


def test_numbers_of_a_pixel(session: Session) -> None:
    frame = render(session.subject.scene, session.subject.params)
    exact = render(session.subject.scene, replace(session.subject.params, method="exact"))
    found = {name: columns for name, *columns in session.numbers({"other": "method=exact"}, 20, 15)}
    assert found["color"] == [frame.color[15, 20].tolist(), exact.color[15, 20].tolist(), None]
    assert found["march.hit_index"][0] == [int(frame.stages["march.hit_index"][15, 20])]
    assert json.dumps(list(found.values()), allow_nan=False)
    outside = {name: columns for name, *columns in session.numbers({}, 0, 0)}
    assert outside["march.hit"][0] == ["nan"] * 3


def test_the_difference_from_the_truth(session: Session) -> None:
    assert 0.0 < (session.difference({"params": {"linear_steps": 1}}) or 0.0) < 1.0
    assert session.difference({"params": {"method": "exact"}}) == 0.0
    assert Session(wall()).difference({}) is None


def test_a_drawing_is_shown_beside_the_reference() -> None:
    subject = block()
    drawn = np.full((36, 48, 3), 7, np.uint8)
    opened = Session(replace(subject, drawing={"color": drawn / 255.0}))
    assert opened.start()["others"][0] == "port"
    picture, _ = opened.shown({"other": "port"}, other=True)
    assert (picture.pixels[..., :3] == 7).all()
    assert opened.numbers({}, 3, 3)[0][3] == pytest.approx([7 / 255] * 3)


def test_maps_are_prepared_once_for_all_places() -> None:
    opened = Session(SUBJECTS["shadows"]())
    opened.shown({})
    made = opened._given["maps"]
    opened.shown({"scene": {"offset_x": 0.25}})
    opened.shown({"params": {"method": "direct"}})
    opened.shown({"scene": {"offset_x": 0.3}})
    assert opened._given["maps"] is made
    opened.shown({"params": {"map_size": 16}})
    assert opened._given["maps"] is not made


def test_what_is_seen_is_a_case(session: Session) -> None:
    case = session.case({"camera": MOVED, "params": {"binary_steps": 2}})
    assert isinstance(case, oracle.Case)
    assert case.params.binary_steps == 2
    with pytest.raises(ValueError, match="method: found 'exact', allowed: protruded"):
        session.case({"params": {"method": "exact"}})


@pytest.mark.parametrize(
    ("state", "words"),
    [
        ({"params": {"linear_steps": 0}}, "linear_steps: found 0, allowed: a whole number from 1"),
        ({"params": {"linear_steps": "9"}}, "linear_steps: found '9'"),
        ({"params": {"nothing": 1}}, "knob: found 'nothing'"),
        ({"params": [1]}, "params: found"),
        ({"scene": {"height": 0}}, "height: found 0, allowed: a finite number > 0"),
        ({"camera": {"eye": [0, 0, 0]}}, "camera: found"),
        ({"camera": {**MOVED, "eye": MOVED["target"]}}, "target: found"),
        ({"camera": {**MOVED, "zoom": 0}}, "zoom: found 0"),
        ({"show": "march.nothing"}, "show: found 'march.nothing'"),
        ({"params": {"interval": "volume", "faces": "base"}}, "faces: found 'base'"),
    ],
)
def test_a_state_that_may_not_be_is_said_in_a_line(session: Session, state: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match="found") as caught:
        session.shown(state)
    assert str(caught.value).startswith(words.partition(":")[0])
    assert words in checks.one_line(caught.value, 2000)


def test_what_has_no_page() -> None:
    with methods.registered(RECORD):
        toy = next(iter(RECORD.cases.open().values()))()
        with pytest.raises(ValueError, match="scene: found 'ramp', allowed: one of displacement"):
            Session(Subject(scene=toy.scene, params=toy.params))
    with pytest.raises(ValueError, match=r"params: found 'Params', allowed: ibr_ref\.displacement"):
        viewer.view(block().scene, wall().params)
    with pytest.raises(ValueError, match="scene: found 'int'"):
        viewer.view(3)


@pytest.mark.parametrize("name", SUBJECTS)
def test_what_a_page_opens_with_is_drawn_before_it_asks(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The picture, what it is compared with, and the numbers of its pixels; as it will be drawn while the view moves."""
    opened = Session(SUBJECTS[name]())
    drawn: list[bool] = []
    draw = opened._draw

    def counted(scene: Any, params: Any, stages: bool) -> Any:
        drawn.append(stages)
        return draw(scene, params, stages)

    monkeypatch.setattr(opened, "_draw", counted)
    opened.warm()
    assert {True, False} <= {*drawn}
    drawn.clear()
    state = {"params": {}, "scene": {}, "camera": None, "show": "color", "other": "", "seam": 0.7}
    opened.start()
    opened.shown(state)
    opened.numbers(state, 0, 0)
    opened.difference(state)
    assert not drawn
