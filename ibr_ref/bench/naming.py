"""How often a FAIL names the bug: `python -m ibr_ref.bench.naming FILE [METHOD...]`.

Each broken port is drawn on every small case of its method, and judged with all stages (`--picture`: by its picture and
depth alone) by ieee32, as which it computes. FILE gets a line of JSON for each; what stands there is not tried again, so
that a run goes on where it stopped. Every sixteenth port comes first, on all cases. `--pairs`: drawn ports with two bugs of
a stage, each of which shows by itself. The table of all that FILE has is Markdown.
"""

from __future__ import annotations

import argparse
import time
import zlib
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ibr_ref.bench import json_lines
from ibr_ref.oracle.cases import Case, build, names
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.judgement import Explains, Handed, Judgement
from ibr_ref.oracle.referees import referee
from ibr_ref.oracle.referees.pairs import AND, composed
from ibr_ref.oracle.self_test import MUTANT_PROFILE, plain_port, port_output, tried
from ibr_ref.oracle.trials import judge

STRIDE = 16
"""Every so many of a method's ports are tried before the others."""
OUTCOMES = ("alone", "with others", "one of two", "not", "wrongly")
"""Of bugs that show: what a FAIL names. Of two bugs one may be all that shows, or all that is needed."""


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
    pair: tuple[str, ...] = ()
    """Of a port with two bugs both."""

    @property
    def outcome(self) -> str | None:
        """One of `OUTCOMES`; None: it does not show."""
        if self.stage is None:
            return None
        if {self.mutant, AND.join(reversed(self.pair))} & {*self.named}:
            return "alone" if len(self.named) == 1 else "with others"
        if {*self.pair} & {*self.named}:
            return "one of two"
        return "wrongly" if self.named else "not"


def named(case: Case, mutant: Mutant, *, picture: bool, pair: tuple[str, ...] = ()) -> Row:
    """One port on one case."""
    device, judge_of = PROFILES[MUTANT_PROFILE], referee(case.method)
    handed, wrong = _wrong(case, mutant.port, picture=picture)
    with np.errstate(all="ignore"):
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
        pair=pair,
    )


def _wrong(case: Case, port: type[Any], *, picture: bool) -> tuple[Handed, Judgement | None]:
    """What a port hands in, and its first wrong stage."""
    with np.errstate(all="ignore"):
        handed = port_output(case, port)
        if picture:
            handed = {name: handed[name] for name in ("color", "depth")}
        judged = judge(case, handed, PROFILES[MUTANT_PROFILE], to_first_wrong=True)
    return handed, next((each for each in judged if each.wrong.any()), None)


def rows_of(file: Path) -> list[Row]:
    """What a run before has written down."""
    return [Row(**fields) for fields in json_lines.read(file)]


def run(file: Path, wanted: Sequence[str], *, picture: bool, seconds: float, pairs: int) -> None:
    """Try what is not in the file, and write each port down."""
    done = {(row.case, row.mutant, row.picture) for row in rows_of(file)}
    ports = (
        _pairs_in_turn(wanted, pairs, picture=picture)
        if pairs
        else ((name, mutant, ()) for name, mutant in _in_turn(wanted))
    )
    for name, mutant, pair in ports:
        if time.process_time() > seconds:
            return
        if (name, mutant.name, picture) in done or not mutant.applies(_built(name).system):
            continue
        json_lines.append(file, named(_built(name), mutant, picture=picture, pair=pair))


_built = cache(build)


def _in_turn(methods: Sequence[str]) -> Iterator[tuple[str, Mutant]]:
    """Every sixteenth port of each method on all its cases before the others of any."""
    for first in range(STRIDE):
        for method in methods:
            for name in names(method):
                if _built(name).kind != "real-sized":
                    yield from ((name, mutant) for mutant in plain_port(method).MUTANTS[first::STRIDE])


def _pairs_in_turn(
    methods: Sequence[str], count: int, *, picture: bool
) -> Iterator[tuple[str, Mutant, tuple[str, ...]]]:
    """So many drawn pairs of bugs of one stage for each small case, one for each in turn."""
    cases = [name for method in methods for name in names(method) if _built(name).kind != "real-sized"]
    draws = {name: np.random.default_rng(zlib.crc32(name.encode())) for name in cases}
    for name in cases * count:
        yield (name, *_drawn_pair(_built(name), draws[name], picture=picture))


def _drawn_pair(case: Case, draw: np.random.Generator, *, picture: bool) -> tuple[Mutant, tuple[str, ...]]:
    """Two that can be had together, and each of which shows."""
    room = plain_port(case.method)
    mutants = [m for m in room.MUTANTS if m.applies(case.system) and not m.survives and not m.hidden]
    while True:
        a, b = (mutants[i] for i in draw.integers(len(mutants), size=2))
        both = composed(room.Port, a, b, a.stage) if a.stage == b.stage and a is not b else None
        if both is not None and all(_wrong(case, each.port, picture=picture)[1] is not None for each in (a, b)):
            return both, (a.name, b.name)


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
        if row.outcome in OUTCOMES[3:]
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
    parser.add_argument(
        "--pairs", type=int, default=0, metavar="COUNT", help="ports with two bugs, so many of each case"
    )
    parser.add_argument("--picture", action="store_true", help="by the picture and its depth alone")
    parser.add_argument(
        "--seconds", type=float, default=float("inf"), help="of processor time, 0: print the table alone"
    )
    found = parser.parse_args()
    run(found.file, found.method or tried(), picture=found.picture, seconds=found.seconds, pairs=found.pairs)
    print(table(rows_of(found.file)))


if __name__ == "__main__":
    main()
