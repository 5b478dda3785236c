"""What `ibr-ref check` judges: cases beside the drawings of the same name, each once for every change of either."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ibr_ref.cli.tables import counted

if TYPE_CHECKING:
    from ibr_ref.oracle.cases import Case
    from ibr_ref.oracle.choice import Choice
    from ibr_ref.oracle.examination import Examination
    from ibr_ref.oracle.verdict import Verdict

Signature = tuple[tuple[str, int, int], ...]
"""Of a file or a folder: each file's name, time of its last change, and size."""


@dataclass(frozen=True, eq=False)
class Finding:
    """A verdict, and how it came about."""

    name: str
    """Of the case's folder and of the drawing's."""
    verdict: Verdict
    examination: Examination | None
    """None: there was nothing to examine."""
    seconds: float
    warning: str | None = None
    """About the case's folder."""


def worst(findings: Sequence[Finding]) -> int:
    """The exit code: 1 if any FAIL, else 2 if any INCONCLUSIVE, else 0."""
    codes = {finding.verdict.outcome.exit_code for finding in findings}
    return next((code for code in (1, 2) if code in codes), 0)


def lines(findings: Sequence[Finding], jobs: int) -> list[str]:
    """A line a case, and one of all."""
    width = max(len(finding.name) for finding in findings)
    rows = [f"{finding.verdict.outcome:12}  {finding.name:{width}}  {_said(finding)}" for finding in findings]
    counts = [finding.verdict.outcome for finding in findings]
    said = ", ".join(f"{counts.count(outcome)} {outcome}" for outcome in dict.fromkeys(sorted(counts, key=str)))
    left = jobs - len(findings)
    return [*rows, f"{counted(len(findings), 'case')}: {said}" + (f"; {left} not tried." if left else ".")]


def _said(finding: Finding) -> str:
    """The rest of its line."""
    verdict = finding.verdict
    if verdict.reasons:
        return verdict.reasons[0]
    how = f"on {verdict.device}"
    first = next((stage for stage in verdict.stages if stage.wrong), None)
    if first is not None:
        blamed = ", ".join(first.blamed)
        how = f"first wrong in {first.stage}: {first.wrong:,} of {first.elements:,} elements, {blamed} ({how})"
        if verdict.causes:
            how += f", explained by {' or '.join(cause.name for cause in verdict.causes)}"
    elif verdict.biases:
        how = f"first wrong in {verdict.first_wrong_stage}: {verdict.biases[0].parameter} ({how})"
    return f"{how}, {finding.seconds:.1f} s"


class Judging:
    """All cases that a word chooses and what a port drew for them; asked again, what has not changed is kept."""

    def __init__(self, word: str, drawn: Path, device: str | None) -> None:
        from ibr_ref.oracle.choice import is_many

        self.word, self.drawn, self.device = word, drawn, device
        self.many = is_many(word)
        self._cases: dict[str, tuple[Signature, Case]] = {}
        self._kept: dict[str, tuple[object, Finding]] = {}

    def jobs(self) -> list[tuple[str, Callable[[], Finding]]]:
        """A name and a judge of each pair, and of what has no partner. Raises ValueError or OSError for no cases at all."""
        from ibr_ref.oracle.choice import chosen
        from ibr_ref.oracle.files.folder import existing_folder

        choices = chosen([self.word])
        if not self.many:
            return [(choices[0].name, lambda: self._single(choices[0]))]
        existing_folder(self.drawn)
        jobs = [(choice.name, self._job(choice)) for choice in choices]
        strangers = sorted(_drawings(self.drawn) - {choice.name for choice in choices}) if self._takes_all() else []
        return jobs + [(name, _without_a_partner(name, "a drawing without a case")) for name in strangers]

    def signature(self) -> object:
        """Changes with whatever is looked at."""
        return _signature(Path(self.word)), _signature(self.drawn)

    def _takes_all(self) -> bool:
        """Whether each drawing should have a case."""
        from ibr_ref.oracle.choice import ALL

        return os.path.isdir(self.word) or self.word == ALL

    def _single(self, choice: Choice) -> Finding:
        return self._again(choice, self.drawn)

    def _job(self, choice: Choice) -> Callable[[], Finding]:
        place = next((p for p in (self.drawn / choice.name, self.drawn / f"{choice.name}.npz") if p.exists()), None)
        if place is None:
            return _without_a_partner(choice.name, f"no drawing: {self.drawn / choice.name} is not there")
        found = place

        def judge() -> Finding:
            try:
                return self._again(choice, found)
            except (ValueError, OSError) as error:
                return _without_a_partner(choice.name, str(error))()

        return judge

    def _again(self, choice: Choice, drawing: Path) -> Finding:
        seen = (_signature(choice.folder), _signature(drawing))
        if choice.name not in self._kept or self._kept[choice.name][0] != seen:
            self._kept[choice.name] = seen, self._judged(choice, drawing)
        return self._kept[choice.name][1]

    def _judged(self, choice: Choice, drawing: Path) -> Finding:
        from ibr_ref import oracle
        from ibr_ref.oracle import files

        started = time.perf_counter()
        case = self._case(choice)
        submission = oracle.load_submission(drawing, case)
        examination = oracle.check(case, submission, profile=self.device)
        warning = None if choice.folder is None else files.outdated(case, choice.folder)
        return Finding(choice.name, examination.verdict, examination, time.perf_counter() - started, warning)

    def _case(self, choice: Choice) -> Case:
        """Read once for each change of its folder: its frame is drawn once too."""
        seen = _signature(choice.folder)
        if choice.name not in self._cases or self._cases[choice.name][0] != seen:
            self._cases[choice.name] = seen, choice.make()
        return self._cases[choice.name][1]


def _without_a_partner(name: str, reason: str) -> Callable[[], Finding]:
    def judge() -> Finding:
        from ibr_ref.oracle.findings import Outcome
        from ibr_ref.oracle.verdict import Verdict

        return Finding(name, Verdict(outcome=Outcome.INCONCLUSIVE, case=name, method="", reasons=(reason,)), None, 0.0)

    return judge


def _drawings(folder: Path) -> set[str]:
    """The names of what lies there: folders, and archives without their suffix."""
    from ibr_ref.oracle.choice import inside

    return {each.name for each in inside(folder)} | {each.stem for each in folder.glob("*.npz")}


def _signature(place: Path | None) -> Signature:
    return () if place is None else tuple(sorted(_files(os.fspath(place))))


def _files(place: str) -> Iterator[tuple[str, int, int]]:
    """What vanishes while it is looked at was not there."""
    try:
        entries = [*os.scandir(place)] if os.path.isdir(place) else []
        if not entries:
            status = os.stat(place)
            yield place, status.st_mtime_ns, status.st_size
    except OSError:
        return
    for entry in entries:
        yield from _files(entry.path)
