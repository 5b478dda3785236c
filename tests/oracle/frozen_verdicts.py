"""All verdicts written down, to compare before a rewrite of the oracle with after it.

    python -m tests.oracle.frozen_verdicts write before.jsonl [--method splatting] [--kinds easy,typical] [--every 60]
    python -m tests.oracle.frozen_verdicts compare before.jsonl after.jsonl

A line for each case and port (every variant and every mutant), with the stages that each device profile finds wrong and in
how many elements; or for one in so many, the same ones in any version: names decide. The file stands alone but for the
package's self-test, so that it also runs on an older version.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from zlib import crc32

from ibr_ref.oracle.cases import build, names
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.self_test import port_output
from ibr_ref.oracle.trials import judge

KINDS = ("easy", "typical", "adversarial")


def ports(module: Any, case: Any) -> Iterator[tuple[str, Any, Any]]:
    """(name, port, variant) of the right port, every variant and every mutant that a port of the case can have."""
    yield "right", module.Port, None
    for variant in module.VARIANTS:
        yield f"variant {variant.name}", variant.port or module.Port, variant
    for mutant in module.MUTANTS:
        if hasattr(mutant, "applies") and not mutant.applies(case.system):
            continue
        yield f"mutant {mutant.name}", mutant.port, None


def module_of(method: str) -> Any:
    """Port, VARIANTS and MUTANTS, in this version and in those before it had a registry."""
    try:
        from ibr_ref.oracle.self_test import plain_port
    except ImportError:
        from importlib import import_module

        return import_module(f"ibr_ref.oracle.ports.{method}")
    return plain_port(method)


def judged(case: Any, handed: Any) -> dict[str, list[list[Any]]]:
    """By profile: [stage, elements, wrong] of every judgement."""
    found = {}
    for name, device in PROFILES.items():
        judgements = judge(case, handed, device)
        found[name] = [[j.stage, int(j.wrong.size), int(j.wrong.sum())] for j in judgements]
    return found


def write(path: Path, method: str, kinds: tuple[str, ...], every: int) -> None:
    """Append what is not there yet."""
    done = {(line["case"], line["port"]) for line in read(path)} if path.exists() else set()
    module = module_of(method)
    with path.open("a") as file:
        for case in (case for case in map(build, names(method)) if case.kind in kinds):
            for name, port, variant in ports(module, case):
                chosen = crc32(f"{case.name} {name}".encode()) % every == 0
                if chosen and (case.name, name) not in done:
                    verdict = judged(case, port_output(case, port, variant))
                    file.write(json.dumps({"case": case.name, "port": name, "verdict": verdict}) + "\n")
                    file.flush()


def read(path: Path) -> list[dict[str, Any]]:
    """The lines of a file."""
    return [json.loads(line) for line in path.read_text().splitlines()]


def wrong(verdict: list[list[Any]]) -> dict[str, int]:
    """Wrong elements by stage."""
    found: dict[str, int] = {}
    for stage, _, count in verdict:
        found[stage] = found.get(stage, 0) + count
    return {stage: count for stage, count in found.items() if count}


def compare(before: Path, after: Path) -> int:
    """Print what differs; the number of verdicts that changed sides."""
    then, now = ({(line["case"], line["port"]): line["verdict"] for line in read(path)} for path in (before, after))
    same = counts = sides = 0
    for key in sorted(then.keys() & now.keys()):
        for profile in then[key].keys() & now[key].keys():
            old, new = wrong(then[key][profile]), wrong(now[key][profile])
            if old == new:
                same += 1
            elif bool(old) == bool(new) and next(iter(old)) == next(iter(new)):
                counts += 1
            else:
                sides += 1
                print(f"{key[0]}, {key[1]}, {profile}: {old or 'right'} -> {new or 'right'}")
    print(f"{same} verdicts the same, {counts} with other counts and the same first stage, {sides} others")
    print(f"only before: {len(then.keys() - now.keys())}, only after: {len(now.keys() - then.keys())} (case, port)")
    return sides


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    writing = commands.add_parser("write")
    writing.add_argument("results", type=Path)
    writing.add_argument("--method", default="splatting")
    writing.add_argument("--kinds", default=",".join(KINDS))
    writing.add_argument("--every", type=int, default=1)
    comparing = commands.add_parser("compare")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    given = parser.parse_args()
    if given.command == "write":
        write(given.results, given.method, tuple(given.kinds.split(",")), given.every)
    else:
        raise SystemExit(1 if compare(given.before, given.after) else 0)


if __name__ == "__main__":
    main()
