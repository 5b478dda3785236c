"""What a page shows, drawn as it asks for it: one scene, and all that may be turned of it."""

from __future__ import annotations

import json
import math
import time
from collections import OrderedDict
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from inspect import signature
from typing import Any

import numpy as np

from ibr_ref import methods
from ibr_ref.io import Frame
from ibr_ref.methods import Method
from ibr_ref.oracle.cases.case import Case, method_of
from ibr_ref.scene import checks
from ibr_ref.scene.documented import meanings
from ibr_ref.viewer.knobs import Knob, turned
from ibr_ref.viewer.pictures import Picture, picture, planes
from ibr_ref.viewer.pose import Pose
from ibr_ref.viewer.room import Viewable

KEPT_FRAMES = 4
"""Whose arrays are kept: of both sides of the wipe, as they are and as they were."""

VISIBLE = 8.5 / 255.0
"""From which difference of a colour on a pixel counts as another."""


@dataclass(frozen=True, eq=False)
class Subject:
    """What is looked at."""

    scene: Any
    """The method's Scene."""
    params: Any
    """The method's Params."""
    inputs: Mapping[str, Any] = field(default_factory=dict)
    """What else `render` is given, as of a `Case`."""
    title: str = ""
    drawing: Mapping[str, Any] = field(default_factory=dict)
    """What a port drew of it, by array: "color" and stages."""


def check(subject: Subject) -> tuple[Method, Viewable]:
    """Its method, and what pages know of it.

    Raises ValueError for a scene of no method, or of one that has no page, and for parameters of another.
    """
    method = methods.named(method_of(subject.scene))
    if method.viewable is None:
        known = " | ".join(m.name for m in methods.records() if m.viewable is not None)
        raise checks.reject("scene", method.name, f"one of {known}, which have pages")
    package = method.package.open()
    if not isinstance(subject.params, package.Params):
        raise checks.reject("params", type(subject.params).__name__, f"{package.__name__}.Params")
    return method, method.viewable.open()


class Session:
    """Answers what pages ask. Not for two threads at once: kernels are called from one."""

    def __init__(self, subject: Subject) -> None:
        """Raise what `check` does."""
        self.subject = subject
        self.method, self.room = check(subject)
        self.contract = self.method.contract.open()
        self.knobs = {"params": self._of_params(), "scene": self.room.knobs(subject.scene)}
        self._given = dict(subject.inputs)
        self._frames: OrderedDict[str, Frame] = OrderedDict()

    def _of_params(self) -> dict[str, Knob]:
        """A knob for each field; a value that no knob can have, such as a list of light samples, stays as it is."""
        params, found = self.subject.params, {}
        says = meanings(type(params))
        for each in fields(params):
            value, limit = getattr(params, each.name), self.room.limits.get(each.name)
            if limit is not None and not isinstance(value, np.ndarray):
                found[each.name] = Knob(limit, value, says.get(each.name, ""), self.room.read_by.get(each.name, ()))
        return found

    # --- What the page opens with ---

    def warm(self) -> None:
        """Draw what the page opens with, as it will when the view moves and when it rests: then all kernels are there.

        What cannot be drawn is said when it is asked for.
        """
        with suppress(ValueError, MemoryError):
            self._draw(*self.described({}), stages=False)
            self._frame({}, stages=True)
            self.difference({})

    def start(self) -> dict[str, Any]:
        """All that the page is made of, as JSON has it."""
        scene, params = self.subject.scene, self.subject.params
        chooser = self.method.judged[0]
        others = [f"{chooser}={word}" for word in getattr(self.knobs["params"][chooser].limit, "allowed", ())]
        truth = [f"{name}={value}" for name, value in self.room.truth.items()]
        return {
            "title": self.subject.title or self.method.title,
            "method": self.method.name,
            "chooser": chooser,
            "size": [scene.camera.width, scene.camera.height],
            "perspective": scene.camera.perspective,
            "knobs": {part: [k.described(name) for name, k in knobs.items()] for part, knobs in self.knobs.items()},
            "camera": Pose.of(scene.camera, self.room.points(scene, params)).fields(),
            "others": [*(["port"] if self.subject.drawing else []), "opened", *others],
            "drawn": [name for name, _ in planes(self.subject.drawing)],
            "truth": truth[0] if truth else None,
            "shows": ["color", "depth", *(n for n, _ in planes(self._frame({}, stages=True).stages))],
        }

    # --- What is asked for ---

    def shown(self, state: Mapping[str, Any], other: bool = False) -> tuple[Picture, float]:
        """The picture of a state, or of what it is compared with, and the seconds that the render took."""
        show, started = str(state.get("show", "color")), time.perf_counter()
        if other and state.get("other") == "port":
            arrays: Mapping[str, Any] = self.subject.drawing
        else:
            frame = self._frame(_other(state) if other else state, stages=show not in ("color", "depth"))
            arrays = {"color": frame.color, "depth": frame.depth, **frame.stages}
        seconds = time.perf_counter() - started
        found = dict(planes(arrays))
        if show not in found:
            raise checks.reject("show", show, " | ".join(found))
        return picture(show, found[show], self.contract), seconds

    def numbers(self, state: Mapping[str, Any], x: Any, y: Any) -> list[list[Any]]:
        """By array: its name and its numbers at a pixel, here, in what is compared, and in the port's drawing."""
        camera = self.subject.scene.camera
        x = checks.whole("x", x, low=0, high=camera.width - 1)
        y = checks.whole("y", y, low=0, high=camera.height - 1)
        here, port = self._at(state, x, y), _at(self.subject.drawing, x, y, camera.height, camera.width)
        beside = self._at(_other(state), x, y) if state.get("other") not in (None, "", "port") else {}
        names = dict.fromkeys([*here, *beside, *port])
        return [[name, here.get(name), beside.get(name), port.get(name)] for name in names]

    def _at(self, state: Mapping[str, Any], x: int, y: int) -> dict[str, list[Any]]:
        frame = self._frame(state, stages=True)
        return _at({"color": frame.color, "depth": frame.depth, **frame.stages}, x, y, *frame.depth.shape)

    def difference(self, state: Mapping[str, Any]) -> float | None:
        """Share of pixels that are visibly other than in what the method approximates; None: that is not known."""
        if not self.room.truth:
            return None
        here = self._frame(state, stages=False).color
        there = self._frame(_with_params(state, self.room.truth), stages=False).color
        return float((np.abs(here - there).max(axis=-1) > VISIBLE).mean())

    def case(self, state: Mapping[str, Any]) -> Case:
        """What is seen, as a case for ports. Raises ValueError for systems that no referee judges."""
        scene, params = self.described(state)
        about = f"Seen in ibr-ref view: {self.subject.title or self.method.title}."
        return Case(name="view", about=about, scene=scene, params=params, inputs=dict(self._inputs(scene, params)))

    # --- How it is drawn ---

    def described(self, state: Mapping[str, Any]) -> tuple[Any, Any]:
        """Scene and parameters of a state. Raises ValueError for what may not be."""
        subject, params = self.subject, turned(self.knobs["params"], _part(state, "params"))
        values = turned(self.knobs["scene"], _part(state, "scene"))
        wanted = replace(subject.params, **params) if params else subject.params
        scene = self.room.changed(subject.scene, values) if values else subject.scene
        if state.get("camera") is not None:
            scene = replace(scene, camera=Pose.read(state["camera"]).seen(subject.scene.camera))
        if params or scene is not subject.scene:  # else the planes are the scene's own
            scene = replace(scene, camera=scene.camera.fitted(self.room.points(scene, wanted)))
        return scene, wanted

    def _frame(self, state: Mapping[str, Any], *, stages: bool) -> Frame:
        """Drawn, or kept from before."""
        key = json.dumps([state.get(part) or {} for part in ("params", "scene", "camera")], sort_keys=True)
        frame = self._frames.pop(key, None)
        if frame is None or (stages and not frame.stages):
            scene, params = self.described(state)
            frame = self._draw(scene, params, stages)
        self._frames[key] = frame
        while len(self._frames) > KEPT_FRAMES:
            self._frames.popitem(last=False)
        return frame

    def _draw(self, scene: Any, params: Any, stages: bool) -> Frame:
        render = self.method.package.open().render
        known = signature(render).parameters
        given = {name: value for name, value in self._inputs(scene, params).items() if name in known}
        frame: Frame = render(scene, params, stages=stages, **given)
        return frame

    def _inputs(self, scene: Any, params: Any) -> Mapping[str, Any]:
        if self.room.prepared is None:
            return self._given
        made = self.room.prepared(scene, params, self._given)
        self._given.update(made)  # for the next frame
        return made


def _part(state: Mapping[str, Any], name: str) -> dict[str, Any]:
    part = state.get(name) or {}
    if not isinstance(part, dict):
        raise checks.reject(name, part, "values by name")
    return part


def _with_params(state: Mapping[str, Any], params: Mapping[str, Any]) -> dict[str, Any]:
    return {**state, "params": {**_part(state, "params"), **params}}


def _other(state: Mapping[str, Any]) -> dict[str, Any]:
    """The state that a state is compared with: as opened, or with another system."""
    other = str(state.get("other"))
    if other == "opened":
        return {**state, "params": {}, "scene": {}}
    name, found, value = other.partition("=")
    if not found:
        raise checks.reject("other", other, "opened | FIELD=VALUE")
    return _with_params(state, {name: value})


def _at(arrays: Mapping[str, Any], x: int, y: int, height: int, width: int) -> dict[str, list[Any]]:
    """The numbers of a pixel, as JSON has them, of the arrays that are of the picture's size."""
    found = {}
    for name, plane in planes(arrays):
        if plane.shape[:2] == (height, width):
            found[name] = [_number(value) for value in np.ravel(plane[y, x]).tolist()]
    return found


def _number(value: float | int | bool) -> float | int | bool | str:
    return value if not isinstance(value, float) or math.isfinite(value) else str(value)
