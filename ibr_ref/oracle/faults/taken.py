"""Numbers of a case as suspects: the right program with another in its place, as a port may have left it or set it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Any

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.faults.kinds import Mutant, PlainPort
from ibr_ref.oracle.programs.program import EACH, Path, changed

LOOKS_LIKE = " looks like "
"""Between a number's name and a value that was found, not guessed."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """A number of a case."""

    path: Path
    """Where it stands; its last word is its name, and "light" before it."""
    stages: tuple[str, ...]
    """Those in which it is read first: a port may have it wrong in one of several."""
    read_by: tuple[str, ...] = ()
    """The program's methods that read it, of those that say what a suspect shares with the right program."""
    among: tuple[Any, ...] = ()
    """All that it may be, where these are few."""
    jumps: bool = False
    """What hangs on it jumps: it is a bound that something is compared with."""

    @property
    def name(self) -> str:
        """As a verdict says it: "linear_steps", "light.ambient", "background.r"."""
        words = [str(part) for part in self.path[1:] if part not in ("polygons", EACH)]
        letters = "rgb" if "background" in words else "xyz"
        return ".".join([*words[:-1], letters[int(words[-1])]] if words[-1].isdigit() else words)

    def value(self, case: Case) -> Any:
        """What the case has."""
        at: Any = case
        for part in self.path:
            at = getattr(at, part) if isinstance(part, str) else at[max(part, 0)]
        return at

    def others(self, case: Case) -> list[Any]:
        """Numbers that ports have by mistake: the default, one more or less, double, half."""
        value = self.value(case)
        whole = isinstance(value, int)
        near = (value + 1, value - 1, 2 * value, value // 2) if whole else (2.0 * value, 0.5 * value)
        return [x for x in dict.fromkeys(self.among or (*self._default(case), *near)) if x != value]

    def _default(self, case: Case) -> list[Any]:
        *path, name = self.path
        if not isinstance(name, str):
            return []
        owner = Setting(path=tuple(path), stages=()).value(case)
        found = next(field.default for field in fields(owner) if field.name == name)
        return [] if found is MISSING or found is None else [found]

    def allows(self, case: Case, value: Any) -> bool:
        """Whether the case may have it."""
        root, *path = self.path
        try:
            changed(getattr(case, str(root)), tuple(path), value)
        except ValueError:
            return False
        return True

    def port(self, port: type[PlainPort], value: Any) -> type[PlainPort]:
        """The right program with another number."""
        return type("Taken", (port,), {"taken": {self.path: value}, "read_by": self.read_by, "__module__": __name__})

    def suspects(self, port: type[PlainPort], case: Case, value: Any, joined: str = " = ") -> list[Mutant]:
        """One for each of the stages; nothing where the number is not allowed."""
        if not self.allows(case, value):
            return []
        name = f"{self.name}{joined}{value:.9g}"
        fault = f"The port is right with {self.name} = {value:.9g}; the case has {self.value(case):.9g}."
        return [Mutant(name=name, fault=fault, stage=stage, port=self.port(port, value)) for stage in self.stages]


def suspects(port: type[PlainPort], case: Case, settings: Sequence[Setting]) -> list[Mutant]:
    """Each other number of each."""
    return [m for each in settings for other in each.others(case) for m in each.suspects(port, case, other)]
