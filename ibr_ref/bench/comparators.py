"""What image comparators in use today make of the ports that the oracle is tried on: `python -m ibr_ref.bench.comparators`.

Every variant and mutant is drawn on the small cases, in 8 bits, and compared with the reference by each comparator at a
threshold that its users publish. A right port that is called different is accused; a broken one that is called equal on all
cases is let through. SSIM and FLIP take part where scikit-image and flip-evaluator are installed. The table is Markdown.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bytes
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case, build, names
from ibr_ref.oracle.self_test import plain_port, tried

Comparator = Callable[[Bytes, Bytes], bool]
KINDS = ("easy", "typical", "adversarial")


def _rmse(a: Bytes, b: Bytes) -> float:
    return float(np.sqrt(np.mean((a / 255.0 - b / 255.0) ** 2)))


def _within(steps: int, share: float) -> Comparator:
    return lambda a, b: float((abs(a.astype(int) - b.astype(int)).max(axis=-1) > steps).mean()) <= share


def _psnr(a: Bytes, b: Bytes) -> float:
    rmse = _rmse(a, b)
    return -20.0 * np.log10(rmse) if rmse else np.inf


def _ssim(a: Bytes, b: Bytes) -> float:
    from skimage.metrics import structural_similarity

    return float(structural_similarity(a, b, channel_axis=-1))


def _flip(a: Bytes, b: Bytes) -> float:
    import flip_evaluator

    images = (image.astype(np.float32) / 255.0 for image in (a, b))
    return float(flip_evaluator.evaluate(*images, "LDR", applyMagma=False)[1])


def comparators() -> dict[str, Comparator]:
    """By what they are called in the table; True: "the same"."""
    found: dict[str, Comparator] = {
        "RMSE < 0.01": lambda a, b: _rmse(a, b) < 0.01,
        "PSNR > 40 dB": lambda a, b: _psnr(a, b) > 40.0,
        "every pixel within 1/255": _within(1, 0.0),
        "every pixel within 3/255": _within(3, 0.0),
        "99 % of the pixels within 4/255 (idiff, Blender's render tests)": _within(4, 0.01),
    }
    if find_spec("skimage"):
        found["SSIM > 0.99"] = lambda a, b: _ssim(a, b) > 0.99
    if find_spec("flip_evaluator"):
        found["mean FLIP < 0.01"] = lambda a, b: _flip(a, b) < 0.01
    return found


def _bytes(color: NDArray[np.float64]) -> Bytes:
    return np.floor(255.0 * np.clip(np.nan_to_num(color), 0.0, 1.0) + 0.5).astype(np.uint8)


def _differences(cases: list[Case], port: type, policy: Policy) -> Iterator[tuple[Bytes, Bytes]]:
    for case in cases:
        drawn = port(case.scene, case.params, policy, case.inputs).render()["color"]
        yield _bytes(case.frame.color), _bytes(drawn)


def counts(method: str) -> dict[str, tuple[int, int, int, int]]:
    """For each comparator: right ports accused and in all, broken ports let through and in all."""
    module = plain_port(method)
    cases = [case for case in map(build, names(method)) if case.kind in KINDS]
    tests = comparators()
    accused, passed = dict.fromkeys(tests, 0), dict.fromkeys(tests, 0)
    for variant in module.VARIANTS:
        pairs = [*_differences(cases, variant.port or module.Port, variant.policy)]
        for name, same in tests.items():
            accused[name] += not all(same(*pair) for pair in pairs)
    for mutant in module.MUTANTS:
        pairs = [*_differences(cases, mutant.port, Policy())]
        for name, same in tests.items():
            passed[name] += all(same(*pair) for pair in pairs)
    sizes = len(module.VARIANTS), len(module.MUTANTS)
    return {name: (accused[name], sizes[0], passed[name], sizes[1]) for name in tests}


def main() -> None:
    """Print the table."""
    wanted = sys.argv[1:] or tried()
    found = {method: counts(method) for method in wanted}
    print("| comparator |" + "".join(f" {m}: right ports accused | broken ones let through |" for m in wanted))
    print("|---|" + "---|---|" * len(wanted))
    for name in comparators():
        cells = [found[method][name] for method in wanted]
        print(f"| {name} |" + "".join(f" {a} of {n} | {p} of {k} |" for a, n, p, k in cells))


if __name__ == "__main__":
    main()
