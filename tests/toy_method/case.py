"""The method in `case.json`, and its cases."""

from __future__ import annotations

from functools import partial
from typing import Any, Literal

from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.schema.base import Inputs, Model, Stored, Vector3, numbers
from ibr_ref.oracle.schema.camera import CameraFile, build_camera, describe_camera
from ibr_ref.oracle.schema.document import Document, Schema
from ibr_ref.scene import Camera
from tests.toy_method.ramp import Params, Scene


class RampParams(Model):
    """How steep it is."""

    gain: float


class RampScene(Model):
    """What it looks like."""

    camera: CameraFile
    tint: Vector3
    background: Vector3


class RampCase(Document):
    """A ramp."""

    method: Literal["ramp"]
    params: RampParams
    scene: RampScene


def describe(case: Case, inputs: Inputs) -> tuple[RampParams, RampScene]:
    camera, tint, background = case.scene.camera, numbers(case.scene.tint), numbers(case.scene.background)
    scene = RampScene(camera=describe_camera(camera), tint=tint, background=background)
    return RampParams(gain=case.params.gain), scene


def build(document: RampCase, stored: Stored) -> tuple[Scene, Params, dict[str, Any]]:
    file = document.scene
    scene = Scene(camera=build_camera(file.camera), tint=file.tint, background=file.background)
    return scene, Params(gain=document.params.gain), {}


def features(document: RampCase) -> set[str]:
    return {"dark"} if document.params.gain == 0.0 else set()


SCHEMA = Schema(document=RampCase, describe=describe, build=build, features=features)


def ramp(name: str, gain: float) -> Case:
    camera = Camera.look_at(eye=(0, 0, 5), target=(0, 0, 0), up=(0, 1, 0), near=1, far=9, width=24, height=16)
    scene, params = Scene(camera=camera, tint=(1.0, 0.5, 0.25)), Params(gain=gain)
    return Case(name=name, method="ramp", kind="easy", about="A ramp.", profile="ieee32", scene=scene, params=params)


CASES = {name: partial(ramp, name, gain) for name, gain in (("ramp-full", 1.0), ("ramp-half", 0.5))}
