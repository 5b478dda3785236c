"""The expected results in `case.json`: every array of the contract (`<method>/contract.py`)."""

from __future__ import annotations

from typing import Any, Literal

from numpy.typing import NDArray

from ibr_ref import methods
from ibr_ref.contract import IMAGE, StageArray, described, is_margin
from ibr_ref.io import Frame
from ibr_ref.oracle.schema.base import StoredFile


class StageFile(StoredFile):
    """An array that the reference has made, and that a port may hand in under the same name."""

    name: str
    """"color", "depth", or stage.array; of an atlas stage.array.page."""
    group: str
    """The stage: the part of the name before the first dot; "image" for the final colour and depth."""
    nothing: str
    """The value where nothing is: no face, no splat, no surface."""
    kind: Literal["result", "margin"]
    """"margin": how close a decision of the reference was, or what it cost; ports need not hand it in."""


def contract_of(method: str) -> dict[str, StageArray]:
    """The table of a method's arrays."""
    contract: dict[str, StageArray] = methods.named(method).contract.open()
    return contract


def flat(stages: dict[str, Any]) -> dict[str, NDArray[Any]]:
    """Stages of several arrays as several arrays: "atlas.color.0", "atlas.color.1" and so on."""
    arrays: dict[str, NDArray[Any]] = {}
    for name, stage in stages.items():
        if isinstance(stage, tuple):
            arrays.update({f"{name}.{page}": array for page, array in enumerate(stage)})
        else:
            arrays[name] = stage
    return arrays


def expected(frame: Frame) -> dict[str, NDArray[Any]]:
    """All arrays of a frame by the names under which they are written and handed in."""
    return {"color": frame.color, "depth": frame.depth, **flat(frame.stages)}


def describe_stages(method: str, frame: Frame) -> tuple[StageFile, ...]:
    """The expected arrays as a document."""
    return tuple(describe_stage(method, name, array) for name, array in expected(frame).items())


def describe_stage(method: str, name: str, array: NDArray[Any]) -> StageFile:
    """One expected array as a document. Raises KeyError for a name that the method's contract does not have."""
    entry = described(contract_of(method), name)
    return StageFile(
        name=name,
        group="image" if name in IMAGE else name.split(".")[0],
        file=f"expected/{name}.npy",
        png="expected/color.png" if name == "color" else None,
        dtype=entry.dtype,
        shape=array.shape,
        meaning=entry.meaning,
        nothing=entry.nothing_words,
        kind="margin" if is_margin(name) else "result",
    )
