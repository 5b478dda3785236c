"""The page of a whole run: all cases in a table that can be sorted, each with a link to its own page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from urllib.parse import quote

import numpy as np
from PIL import Image

from ibr_ref.array_types import Bytes
from ibr_ref.io.outputs import atomic
from ibr_ref.oracle.examination import Examination
from ibr_ref.oracle.findings import Findings, StageVerdict
from ibr_ref.oracle.probe import DRIVER_FAULTS, Measured
from ibr_ref.oracle.report import pictures
from ibr_ref.oracle.report.page import asset, template

INDEX = "index.html"
"""The run's page in the folder of all pages."""

THUMBNAIL = 96
"""Pixels of the longer side of a case's picture."""


@dataclass(frozen=True)
class Entry:
    """A case of the run."""

    name: str
    verdict: Findings
    seconds: float
    picture: str | None
    """The case as it should be and as the port drew it, beside each other; None: there is no such picture."""
    page: bool
    """Whether it has a page of its own, NAME.html beside this one."""

    @property
    def first(self) -> str:
        """Where it goes wrong, or why it could not be judged."""
        if self.verdict.reasons:
            return self.verdict.reasons[0]
        stage = self.wrong_stage
        return self.verdict.first_wrong_stage or "" if stage is None else ", ".join(stage.blamed) or stage.stage

    @property
    def causes(self) -> str:
        """What would explain that."""
        return ", ".join(cause.name for cause in self.verdict.causes or ())

    @property
    def share(self) -> float:
        """Of the first wrong stage's elements, that are wrong."""
        stage = self.wrong_stage
        return 0.0 if stage is None else stage.wrong / max(stage.elements, 1)

    @property
    def wrong_stage(self) -> StageVerdict | None:
        """The first."""
        return next((stage for stage in self.verdict.stages if stage.wrong), None)

    @property
    def link(self) -> str:
        """The address of its page."""
        return quote(f"{self.name}.html")


@dataclass(frozen=True)
class Facts:
    """The device that a run was drawn on."""

    port: str
    words: str
    """The device, as its driver calls it."""
    declares: Mapping[str, int | str]
    """As the port declares it."""
    measured: Measured
    unmeasured: Mapping[str, str] = field(default_factory=dict)
    """Probes that were not drawn, and why."""

    @property
    def faults(self) -> list[tuple[str, str, str]]:
        """The driver's: name, what it means, what shows it."""
        return [(name, DRIVER_FAULTS[name], why) for name, why in self.measured.faults.items()]


def entry(name: str, verdict: Findings, seconds: float, examination: Examination | None) -> Entry:
    """Of what has been judged; its pictures are not kept."""
    picture = None if examination is None else _thumbnails(examination)
    return Entry(name, verdict, seconds, picture, page=examination is not None)


def write_run(entries: Sequence[Entry], folder: str | PathLike[str], facts: Facts | None = None) -> None:
    """Write the page into the folder of all pages. Raises OSError with the path."""
    with atomic(Path(folder) / INDEX) as file:
        file.write(run_page(entries, facts).encode("utf-8"))


def run_page(entries: Sequence[Entry], facts: Facts | None = None) -> str:
    """The page as text; with the device above the table where one is known."""
    outcomes = [str(each.verdict.outcome) for each in entries]
    counts = ", ".join(f"{outcomes.count(o)} {o}" for o in dict.fromkeys(sorted(outcomes)))
    return template("run.html").render(
        entries=entries,
        facts=facts,
        usual=_usual_device(entries) if facts else None,
        counts=counts,
        style=asset("page.css"),
        script=asset("run.js"),
    )


def _usual_device(entries: Sequence[Entry]) -> str | None:
    """The one that most cases were judged by: it is said once, above the table."""
    devices = Counter(each.verdict.device for each in entries if each.verdict.device)
    return max(devices, key=lambda device: devices[device], default=None)


def _thumbnails(examination: Examination) -> str:
    shown = [pictures.reference(examination), pictures.port(examination)]
    small = [_small(picture) for picture in shown if picture is not None]
    return pictures.address(np.concatenate(small, axis=1))


def _small(picture: Bytes) -> Bytes:
    image = Image.fromarray(picture)
    image.thumbnail((THUMBNAIL, THUMBNAIL))
    return np.asarray(image)
