"""How soon hunts find the bugs that the oracle is tried on, and how small they get: `python -m ibr_ref.bench.hunts FILE`.

Each broken port that a picture can show is hunted until its first bug is found and made smaller, by processor time. FILE
gets a line of JSON for each; what stands there is not hunted again, so that a run goes on where it stopped. Every fourth
port comes first. The table of all that FILE has is Markdown.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from statistics import median
from typing import Any

from ibr_ref.bench import json_lines
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case, build, names
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.self_test import MUTANT_PROFILE, plain_port, tried
from ibr_ref.testing import Found, Hunt, drawing

STRIDE = 4
"""Every so many of a method's ports are hunted before the others."""

LIMIT = 16
"""Pixels a side that a case may have at the most."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """A hunt. Numbers of the case are those after shrinking, and None where nothing was found."""

    method: str
    mutant: str
    stage: str
    """In which it is wrong."""
    tried: int
    """Cases, before the first that showed it, or in all."""
    seconds: float
    """Processor time until then."""
    found: str | None = None
    """The bug's name."""
    pixels: tuple[int, int] | None = None
    texels: int | None = None
    steps: int | None = None


def hunted(method: str, mutant: Mutant, seconds: float, shrinking: float) -> Row:
    """One hunt for one bug."""

    def draw(case: Case) -> Any:
        return mutant.port(case.scene, case.params, Policy(), case.inputs).render()

    system = mutant.only[0] if mutant.only else None
    hunt = Hunt(
        port=drawing(draw), methods=(method,), system=system, device=MUTANT_PROFILE, shrinking=shrinking,
        clock=time.process_time,
    )  # fmt: skip
    _warm(method)
    about: dict[str, Any] = {"method": method, "mutant": mutant.name, "stage": mutant.stage}
    for found in hunt.run(seconds):
        return Row(**about, tried=found.after, seconds=round(found.seconds, 2), **_size(found))
    return Row(**about, tried=hunt.tried, seconds=seconds)


@cache
def _warm(method: str) -> None:
    """Kernels are compiled, or read, before anything is measured."""
    build(names(method)[0]).frame  # noqa: B018


def _size(found: Found) -> dict[str, Any]:
    case = found.case
    camera = case.scene.camera
    texels, steps = _SIZES[case.method](case)
    return {"found": found.bug.name, "pixels": (camera.width, camera.height), "texels": texels, "steps": steps}


def _of_displacement(case: Case) -> tuple[int, int]:
    """Texels of the height maps, and N + M + S."""
    params = case.params
    texels = sum(len(p.height_map) * len(p.height_map[0]) for p in case.scene.polygons)
    return texels, params.linear_steps + params.binary_steps + params.shadow_steps


def _of_splatting(case: Case) -> tuple[int, int]:
    """Pixels of the depth images, and how many there are."""
    images = case.scene.images
    return sum(len(i.depth) * len(i.depth[0]) for i in images), len(images)


def _of_shadows(case: Case) -> tuple[int, int]:
    """Texels of one map, and samples of the light."""
    samples = case.params.light_samples
    return case.params.map_size**2, samples if isinstance(samples, int) else len(samples)


_SIZES = {"displacement": _of_displacement, "splatting": _of_splatting, "shadows": _of_shadows}


def visible(method: str) -> list[Mutant]:
    """The broken ports that a picture can show."""
    return [mutant for mutant in plain_port(method).MUTANTS if not (mutant.survives or mutant.hidden)]


def rows_of(file: Path) -> list[Row]:
    """What a run before has written down."""
    return [Row(**fields) for fields in json_lines.read(file)]


def run(file: Path, wanted: Sequence[str], seconds: float, shrinking: float) -> None:
    """Hunt what is not in the file, and write each hunt down when it is over."""
    done = {(row.method, row.mutant) for row in rows_of(file)}
    for method, mutant in _in_turn({name: visible(name) for name in wanted}):
        if (method, mutant.name) in done:
            continue
        json_lines.append(file, hunted(method, mutant, seconds, shrinking))


def _in_turn(ports: dict[str, list[Mutant]]) -> Iterator[tuple[str, Mutant]]:
    """Every fourth one of each method before the others of any."""
    for first in range(STRIDE):
        for method, found in ports.items():
            yield from ((method, mutant) for mutant in found[first::STRIDE])


def table(rows: Sequence[Row]) -> str:
    """Of each method, and of what was not found."""
    lines = [
        "| method | hunted | found | after cases, median (most) | after s (most) | pixels, median (most) | texels | steps |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for method in dict.fromkeys(row.method for row in rows):
        of_it = [row for row in rows if row.method == method]
        found = [row for row in of_it if row.found]
        cells = [method, str(len(of_it)), f"{len(found)} ({len(found) / len(of_it):.1%})"]
        if found:
            pixels = [row.pixels[0] * row.pixels[1] for row in found if row.pixels]
            cells += [
                f"{median(row.tried for row in found):.0f} ({max(row.tried for row in found)})",
                f"{median(row.seconds for row in found):.1f} ({max(row.seconds for row in found):.1f})",
                f"{median(pixels):.0f} ({max(pixels)})",
                f"{median(row.texels or 0 for row in found):.0f}",
                f"{median(row.steps or 0 for row in found):.0f}",
            ]
        lines.append(f"| {' | '.join(cells)} |")
    missed = [f"- {row.method}: {row.mutant} ({row.stage}), {row.tried} cases" for row in rows if not row.found]
    large = [f"- {row.mutant}: {row.pixels}" for row in rows if row.pixels and max(row.pixels) > LIMIT]
    return "\n".join(
        [*lines, *(["", "Not found:", *missed] if missed else []), *(["", "Large:", *large] if large else [])]
    )


def main() -> None:
    """Hunt and print the table."""
    parser = argparse.ArgumentParser(prog="python -m ibr_ref.bench.hunts")
    parser.add_argument("file", type=Path)
    parser.add_argument("method", nargs="*", help=f"{' '.join(tried())}; without: all")
    parser.add_argument("--seconds", type=float, default=60.0, help="for each port, 0: print the table alone")
    parser.add_argument("--shrinking", type=float, default=20.0)
    found = parser.parse_args()
    if found.seconds > 0.0:
        run(found.file, found.method or tried(), found.seconds, found.shrinking)
    print(table(rows_of(found.file)))


if __name__ == "__main__":
    main()
