"""A verdict in words."""

from __future__ import annotations

from collections import Counter
from itertools import groupby

from ibr_ref.oracle.device import spelled
from ibr_ref.oracle.findings import Findings, Nearest, Outcome, StageVerdict, Witness
from ibr_ref.oracle.referees.rows import DIFFERS

MOST_LINES = 30
"""Of a trace; a longer one is folded."""


def words(verdict: Findings, *, trace: bool = True) -> str:
    """Some ten lines: what, where first, how many, one that is wrong, what would explain it; and that one's `trace`."""
    lines = [_headline(verdict)]
    lines += [f"  {reason}" for reason in verdict.reasons]
    parts = Counter(stage.stage for stage in verdict.stages)
    lines += [_stage_line(stage, alone=parts[stage.stage] == 1) for stage in verdict.stages]
    for witness in verdict.witnesses:
        lines.append(_witness_line(witness, first=witness is verdict.witness))
        lines += folded(_trace_lines(witness)) if trace else []
    if verdict.needs:
        needs = spelled(None, verdict.needs)
        lines.append(f"  {verdict.first_wrong_stage} would be right with {needs}: declare it if your device has it.")
    lines += _causes(verdict)
    for convention in verdict.conventions:
        if convention.explains:
            left = "all of it" if convention.wrong == 0 else f"all but {convention.wrong:,} pixels"
            lines.append(f"  {convention.name} would explain {left}.")
    for bias in verdict.biases:
        lines.append(
            f"  {bias.parameter} = {bias.looks_like:.6g} in place of {bias.value:.6g} would explain "
            f"{100 * bias.explained:.0f} % of the difference (a legal device: within {bias.legal:.2g})."
        )
    if verdict.undecided_share is not None:
        width = (
            "" if verdict.median_width is None else f", median width of the accepted colours {verdict.median_width:.2g}"
        )
        lines.append(f"  Undecided: {100 * verdict.undecided_share:.3f} % of the hit pixels{width}.")
    if verdict.not_judged:
        lines.append(f"  Not judged: {', '.join(verdict.not_judged)}; a port's own may be any.")
    return "\n".join(lines)


def _causes(verdict: Findings) -> list[str]:
    """Which known bugs and numbers of the case explain it."""
    if verdict.causes is None:
        return []
    ended = [] if verdict.suspects is None else [f"  Stopped looking for the bug after {verdict.suspects} suspects."]
    if not verdict.causes:
        return ended or ["  No known bug and no number of the case explains all of it.", *_nearest(verdict.nearest)]
    if len(verdict.causes) == 1:
        (cause,) = verdict.causes
        alone = "" if ended else ", and by no other"
        known = "two bugs together, by neither alone" if cause.together else f"a known cause{alone}"
        return [f"  Explained by {known}: {cause.name}. {cause.says}", *ended]
    known = "pairs of bugs" if verdict.causes[0].together else "known causes"
    lines = [f"  Explained by {len(verdict.causes)} {known}, which this case does not tell apart:"]
    return lines + [f"    {cause.name}: {cause.says}" for cause in verdict.causes] + ended


def _nearest(found: Nearest | None) -> list[str]:
    """What explains a part, and where it does not."""
    if found is None:
        return []
    first = f"{found.element} {list(found.index)}"
    left = first if found.left == 1 else f"{found.left:,}, the first {first}"
    return [f"  {found.name} comes nearest, and leaves {left}. {found.says}"]


def _headline(verdict: Findings) -> str:
    head = f"{verdict.outcome}: {verdict.case}"
    if verdict.outcome is Outcome.INCONCLUSIVE:
        return f"{head}, the submission cannot be judged."
    explains = verdict.device is not None and verdict.tried.get(verdict.device) == 0
    how = "declared" if verdict.declared else "the tightest" if explains else "the loosest"
    if verdict.outcome is Outcome.PASS:
        return f"{head}, every element is what a correct port may have on {verdict.device} ({how})."
    return f"{head}, first wrong in stage {verdict.first_wrong_stage}, judged by {verdict.device} ({how})."


def _stage_line(stage: StageVerdict, *, alone: bool) -> str:
    """alone: all of the stage is judged at once; else the arrays say which part of it this is."""
    name = stage.stage if alone else f"{stage.stage} ({', '.join(stage.arrays)})"
    own = f", fed with the port's {', '.join(stage.replayed)}" if stage.replayed else ""
    if stage.right:
        return f"  {name}: right ({_counted(stage.elements, stage.element)}{own})."
    box = stage.box
    where = "" if box is None else f", from {list(box.first)} to {list(box.last)}"
    blamed = ", ".join(f"{name} in {count:,}" for name, count in stage.blamed.items())
    share = 100 * stage.wrong / stage.elements
    return f"  {name}: {_counted(stage.wrong, stage.element)} wrong ({share:.3g} %){where}: {blamed}{own}."


def _counted(count: int, element: str) -> str:
    """As in 1 pixel, 12 vertices."""
    several = {"vertex": "vertices", "axis": "axes"}.get(element, f"{element}s")
    return f"{count:,} {element if count == 1 else several}"


def _witness_line(witness: Witness, *, first: bool) -> str:
    name = "Witness" if first else f"Witness of {witness.stage}"
    return (
        f"  {name}: {witness.element} {list(witness.index)}, {witness.array}: "
        f"reference {witness.reference}, port {witness.port}."
    )


def folded(lines: list[str]) -> list[str]:
    """A long trace without its middle, but for what differs there."""
    if len(lines) <= MOST_LINES:
        return lines
    ends = MOST_LINES // 3 + 1
    kept = [i < ends or i >= len(lines) - ends for i in range(len(lines))]
    most = (MOST_LINES - 2 * ends) // 2 - 1  # each of them parts a gap, which has a line of its own
    for i in [i for i, line in enumerate(lines) if line.endswith(DIFFERS) and not kept[i]][:most]:
        kept[i] = True
    result: list[str] = []
    for shown, run in groupby(zip(kept, lines, strict=True), key=lambda each: each[0]):
        part = [line for _, line in run]
        result += part if shown else [f"    ... {len(part):,} more, all in --json and --report"]
    return result


def _trace_lines(witness: Witness) -> list[str]:
    lines = []
    for step in witness.trace:
        decided = ""
        if step.margin is not None:
            decided = f"  (margin {step.margin:.3g}" + (f", bound {step.bound:.3g})" if step.bound is not None else ")")
        port = f" | port {step.port}" if step.port else ""
        note = f"  {step.note}" if step.note else ""
        lines.append(f"    {step.step}: {step.reference}{port}{decided}{note}")
    return lines
