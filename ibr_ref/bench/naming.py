"""How often a FAIL names the bug: `python -m ibr_ref.bench.naming FILE [METHOD...]`.

Each broken port is drawn on every small case of its method, and judged with all stages (`--picture`: by its picture and
depth alone) by ieee32, as which it computes. FILE gets a line of JSON for each; what stands there is not tried again, so
that a run goes on where it stopped. Every sixteenth port comes first, on all cases. The table of all that FILE has is
Markdown.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

import numpy as np

from ibr_ref.oracle.cases import Case, build, names
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.judgement import Explains
from ibr_ref.oracle.referees import referee
from ibr_ref.oracle.self_test import MUTANT_PROFILE, plain_port, port_output, tried
from ibr_ref.oracle.trials import judge

STRIDE = 16
"""Every so many of a method's ports are tried before the others."""
OUTCOMES = ("alone", "with others", "not", "wrongly")
"""Of bugs that show: what a FAIL names."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """A broken port on a case."""

    case: str
    mutant: str
    picture: bool
    """By its picture and depth alone."""
    stage: str | None
    """The first wrong one; None: it does not show."""
    elements: int
    """Wrong there."""
    named: tuple[str, ...]
    seconds: float
    """Processor time of naming."""

    @property
    def outcome(self) -> str | None:
        """One of `OUTCOMES`; None: it does not show."""
        if self.stage is None:
            return None
        if self.mutant in self.named:
            return "alone" if len(self.named) == 1 else "with others"
        return "wrongly" if self.named else "not"


def named(case: Case, mutant: Mutant, *, picture: bool) -> Row:
    """One port on one case."""
    device, judge_of = PROFILES[MUTANT_PROFILE], referee(case.method)
    with np.errstate(all="ignore"):
        handed = port_output(case, mutant.port)
        if picture:
            handed = {name: handed[name] for name in ("color", "depth")}
        judged = judge(case, handed, device, to_first_wrong=True)
        wrong = next((each for each in judged if each.wrong.any()), None)
        begun = time.process_time()
        assert isinstance(judge_of, Explains)
        found = None if wrong is None else judge_of.causes(case, device, handed, wrong)
    return Row(
        case=case.name,
        mutant=mutant.name,
        picture=picture,
        stage=None if wrong is None else wrong.stage,
        elements=0 if wrong is None else int(wrong.wrong.sum()),
        named=() if found is None else tuple(cause.name for cause in found.causes),
        seconds=round(time.process_time() - begun, 2),
    )


def rows_of(file: Path) -> list[Row]:
    """What a run before has written down."""
    lines = file.read_text("utf-8").splitlines() if file.exists() else []
    read = map(json.loads, lines)
    return [Row(**{**fields, "named": tuple(fields["named"])}) for fields in read]


def run(file: Path, wanted: Sequence[str], *, picture: bool, seconds: float) -> None:
    """Try what is not in the file, and write each port down."""
    done = {(row.case, row.mutant, row.picture) for row in rows_of(file)}
    for name, mutant in _in_turn(wanted):
        if time.process_time() > seconds:
            return
        if (name, mutant.name, picture) in done or not mutant.applies(_built(name).system):
            continue
        row = named(_built(name), mutant, picture=picture)
        with file.open("a", encoding="utf-8") as lines:
            lines.write(json.dumps(asdict(row)) + "\n")


_built = cache(build)


def _in_turn(methods: Sequence[str]) -> Iterator[tuple[str, Mutant]]:
    """Every sixteenth port of each method on all its cases before the others of any."""
    for first in range(STRIDE):
        for method in methods:
            for name in names(method):
                if _built(name).kind != "real-sized":
                    yield from ((name, mutant) for mutant in plain_port(method).MUTANTS[first::STRIDE])


def table(rows: Sequence[Row]) -> str:
    """Of each case, of each method, and what was not named."""
    lines = [f"| case | tried | show | {' | '.join(OUTCOMES)} |", f"|{'---|' * (len(OUTCOMES) + 3)}"]
    for kept in ([row for row in rows if not row.picture], [row for row in rows if row.picture]):
        lines += [_line(each, [row for row in kept if row.case == each]) for each in sorted({row.case for row in kept})]
        for method in tried():
            of_it = [row for row in kept if row.case.startswith(method)]
            if of_it:
                lines.append(_line(f"**{method}{', by the picture' if of_it[0].picture else ''}**", of_it))
    missed = [
        f"- {row.case}{' (picture)' if row.picture else ''}: {row.mutant}, {row.elements} in {row.stage}, "
        f"named {' or '.join(row.named) or 'nothing'}"
        for row in rows
        if row.outcome in OUTCOMES[2:]
    ]
    return "\n".join([*lines, *(["", "Not named, or wrongly:", *missed] if missed else [])])


def _line(name: str, rows: Sequence[Row]) -> str:
    counted = Counter(row.outcome for row in rows)
    shown = len(rows) - counted[None]
    return f"| {name} | {len(rows)} | {shown} | {' | '.join(str(counted[outcome]) for outcome in OUTCOMES)} |"


def main() -> None:
    """Name bugs and print the table."""
    parser = argparse.ArgumentParser(prog="python -m ibr_ref.bench.naming")
    parser.add_argument("file", type=Path)
    parser.add_argument("method", nargs="*", help=f"{' '.join(tried())}; without: all")
    parser.add_argument("--picture", action="store_true", help="by the picture and its depth alone")
    parser.add_argument(
        "--seconds", type=float, default=float("inf"), help="of processor time, 0: print the table alone"
    )
    found = parser.parse_args()
    run(found.file, found.method or tried(), picture=found.picture, seconds=found.seconds)
    print(table(rows_of(found.file)))


if __name__ == "__main__":
    main()
