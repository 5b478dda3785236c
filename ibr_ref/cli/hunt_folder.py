"""The folder of `ibr-ref hunt`: cases, drawings and reports of what is found, and how far the hunt has come."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ibr_ref import oracle
    from ibr_ref.testing import Bug, Drawer, Found, Hunt

_STATE = "hunt.json"


@dataclass(frozen=True)
class State:
    """How far a hunt has come."""

    bugs: tuple[Bug, ...] = ()
    rounds: int = 0


@dataclass(frozen=True)
class Folder:
    """Where a hunt keeps what it has found."""

    place: Path

    def state(self) -> State:
        """Of the hunt before; makes the folder. Raises OSError and ValueError for one that is none of a hunt."""
        from ibr_ref.io.outputs import make_folder
        from ibr_ref.scene import checks
        from ibr_ref.testing import Bug

        make_folder(self.place)
        path = self.place / _STATE
        if not path.exists():
            if any(self.place.iterdir()):
                raise FileExistsError(
                    f"{checks.named(self.place)}: holds other things, allowed: a new folder, or a hunt's"
                )
            return State()
        try:
            fields: dict[str, Any] = json.loads(path.read_bytes())
            bugs = tuple(
                Bug(str(bug["method"]), str(bug["stage"]), str(bug["array"]), tuple(map(str, bug["causes"])))
                for bug in fields["bugs"]
            )
            return State(bugs, int(fields["rounds"]))
        except (ValueError, KeyError, TypeError):
            raise ValueError(f"{checks.named(path)}: found what no hunt wrote, allowed: a hunt's {_STATE}") from None

    def note(self, hunt: Hunt) -> None:
        """Write down what is known."""
        from ibr_ref.io.outputs import atomic

        bugs = [bug._asdict() for bug in sorted(hunt.known)]
        text = json.dumps({"seed": hunt.seed, "rounds": hunt.rounds, "bugs": bugs}, indent=1)
        with atomic(self.place / _STATE) as file:
            file.write(text.encode() + b"\n")

    def is_mended(self, bug: Bug, drawer: Drawer, device: str | None) -> bool:
        """Whether the port is right on the case of a known bug; what it draws of it now is kept."""
        from ibr_ref import oracle
        from ibr_ref.testing import bug_of

        folder = self._case(bug.name)
        return folder.exists() and bug_of(oracle.load_case(folder), partial(self._draw, drawer), device) is None

    def _case(self, name: str) -> Path:
        """Where a bug's case is."""
        return self.place / "cases" / name

    def _draw(self, drawer: Drawer, case: oracle.Case) -> oracle.Submission:
        """What the port draws of a case that is kept, which is kept too. Raises PortError where it does not."""
        from ibr_ref import oracle
        from ibr_ref.io.outputs import make_folder

        drawn = make_folder(self.place / "drawn" / case.name)
        drawer.draw(self._case(case.name).resolve(), drawn.resolve())
        return oracle.load_submission(drawn, case)

    def keep(self, found: Found, drawer: Drawer, device: str | None) -> str:
        """Write case, drawing and report; the first line of the verdict."""
        from ibr_ref import oracle
        from ibr_ref.io.outputs import make_folder
        from ibr_ref.testing import PortError

        name = found.bug.name
        about = f"{found.case.about} ibr-ref hunt, seed {found.seed}: {found.bug.array} of {found.bug.stage}."
        case = replace(found.case, name=name, about=about)
        oracle.export(case, self._case(name), force=True)
        try:
            submission = self._draw(drawer, case)
        except PortError as error:
            return f"{name}: {error}"
        problems = [str(problem) for problem in submission.problems]
        examination = oracle.examine(
            case, submission.handed, profile=device or submission.declaration, problems=problems
        )
        oracle.write_report(examination, make_folder(self.place / "reports") / f"{name}.html")
        return examination.verdict.words().partition("\n")[0]
