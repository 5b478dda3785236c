"""The oracle tried on itself: no legal variant may be accused, every mutant should be killed, in its own stage."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ibr_ref import methods as registry
from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.bias import biases
from ibr_ref.oracle.cases import Case, build, names
from ibr_ref.oracle.declaration import device_of
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.faults.kinds import Mutant, PlainPort, Variant
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.trials import judge

MUTANT_PROFILE = "ieee32"
"""Mutants compute in float32 with correct rounding, and say so."""


@dataclass(frozen=True, kw_only=True)
class VariantResult:
    """A legal variant on all cases."""

    method: str
    name: str
    profile: str
    cases: int
    pixels: int
    """Judged in all."""
    accused: tuple[str, ...]
    """"case: stage" where elements were called wrong; empty is right."""


@dataclass(frozen=True, kw_only=True)
class MutantResult:
    """A mutant, on the cases in their order until it was killed both with stages and by its image alone."""

    method: str
    mutant: Mutant
    case: str | None
    """On which it was killed with stages."""
    stage: str | None
    """The first wrong stage that the verdict named there."""
    elements: int
    """Wrong there, in that stage."""
    image_case: str | None
    """On which its picture and depth alone were enough."""
    image_pixels: int

    @property
    def stage_right(self) -> bool:
        """Whether the verdict named the stage in which the bug is."""
        return self.stage == self.mutant.stage


def port_output(case: Case, port: type[PlainPort], variant: Variant | None = None) -> Handed:
    """All arrays of a plain port on a case; colours of a port that makes bytes as bytes."""
    policy = Policy() if variant is None else variant.policy
    arrays = port(case.scene, case.params, policy, case.inputs).render()
    if policy.color_bits == 8:
        arrays["color"] = color_bytes(np.asarray(arrays["color"], np.float64))
    return arrays


def try_variants(method: str) -> Iterator[VariantResult]:
    """Every variant of a method on all its cases, by the profile that it states."""
    module = plain_port(method)
    cases = [build(name) for name in names(method)]
    for variant in module.VARIANTS:
        accused, pixels = [], 0
        for case in cases:
            handed = port_output(case, variant.port or module.Port, variant)
            judgements = judge(case, handed, device_of(variant.profile))
            accused += [f"{case.name}: {j.stage}" for j in judgements if j.wrong.any()]
            image = judgements[-1]
            accused += [
                f"{case.name}: {bias.parameter}"
                for bias in biases(case, handed, image, device_of(variant.profile), wrong=False)
                if not image.wrong.any()
            ]
            pixels += image.wrong.size
        yield VariantResult(
            method=method,
            name=variant.name,
            profile=variant.profile,
            cases=len(cases),
            pixels=pixels,
            accused=tuple(accused),
        )


def try_mutants(method: str, *, kinds: Sequence[str]) -> Iterator[MutantResult]:
    """Every mutant of a method, on its cases of some kinds."""
    module = plain_port(method)
    cases = [case for case in map(build, names(method)) if case.kind in kinds]
    for mutant in module.MUTANTS:
        yield _try_mutant(method, mutant, [case for case in cases if mutant.applies(case.system)])


def _try_mutant(method: str, mutant: Mutant, cases: Sequence[Case]) -> MutantResult:
    device = PROFILES[MUTANT_PROFILE]
    by_stages: tuple[str, Judgement] | None = None
    by_image: tuple[str, int] | None = None
    for case in cases:
        handed = port_output(case, mutant.port)
        alone = {name: handed[name] for name in ("color", "depth")}
        # The picture is judged from the case alone, with stages beside it or without.
        *stages, image = judge(case, alone if by_stages else handed, device)
        if by_stages is None:
            wrong = next((j for j in [*stages, image] if j.wrong.any()), None)
            by_stages = None if wrong is None else (case.name, wrong)
        if by_image is None:
            if image.wrong.any():
                by_image = case.name, int(image.wrong.sum())
            elif biases(case, alone, image, device, wrong=False):
                by_image = case.name, image.wrong.size
        if by_stages and by_image:
            break
    return MutantResult(
        method=method,
        mutant=mutant,
        case=by_stages[0] if by_stages else None,
        stage=by_stages[1].stage if by_stages else None,
        elements=int(np.sum(by_stages[1].wrong)) if by_stages else 0,
        image_case=by_image[0] if by_image else None,
        image_pixels=by_image[1] if by_image else 0,
    )


def size(methods: Sequence[str]) -> int:
    """How many variants and mutants the methods have."""
    modules = [plain_port(method) for method in methods]
    return sum(len(module.VARIANTS) + len(module.MUTANTS) for module in modules)


def plain_port(method: str) -> Any:
    """The method's Port, VARIANTS and MUTANTS. Raises ValueError for a method that has none."""
    found = registry.named(method).plain_port
    if found is None:
        raise ValueError(f"method: found {method!r}, which has no plain port, allowed: {' | '.join(tried())}")
    return found.open()


def tried() -> tuple[str, ...]:
    """The methods that the oracle is tried on."""
    return tuple(method.name for method in registry.records() if method.plain_port is not None)
