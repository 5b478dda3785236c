"""What a sweep found: its rows, the frontier of error against cost, and the cheapest setting that is good enough."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any

from ibr_ref.io.extras import needed
from ibr_ref.io.outputs import atomic
from ibr_ref.scene import checks
from ibr_ref.sweep.measures import Measure
from ibr_ref.sweep.settings import Setting, words
from ibr_ref.sweep.store import EXTRA

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Outcome:
    """A setting, over all views that have something to measure."""

    setting: Setting
    error: float
    """Of the view where it is worst."""
    cost: float
    """Mean of the views."""

    def __str__(self) -> str:
        return words(self.setting)


@dataclass(frozen=True, eq=False)
class Sweep:
    """The rows of a sweep, one a setting and view."""

    method: str
    settings: Sequence[Setting]
    measures: Mapping[str, Measure]
    table: Any
    """`pyarrow.Table`: a column for each parameter, "view", and one for each measure, null where there is nothing to
    measure. Settings in the order of the product, the last parameter fastest, and in each the views. All columns but
    "milliseconds" are the same on any number of workers and any machine."""
    error: str
    """The measure that outcomes are about."""
    cost: str

    def __post_init__(self) -> None:
        for name in ("error", "cost"):
            checks.choice(name, getattr(self, name), tuple(self.measures))

    def by(self, *, error: str | None = None, cost: str | None = None) -> Sweep:
        """The same rows, for another measure of error or of cost. Raises ValueError for what is none."""
        return Sweep(self.method, self.settings, self.measures, self.table, error or self.error, cost or self.cost)

    @property
    def outcomes(self) -> list[Outcome]:
        """All settings, in order; those without anything to measure are left out."""
        views = len(self.table) // len(self.settings)
        errors, costs = (self.table.column(name).to_pylist() for name in (self.error, self.cost))
        found = []
        for i, setting in enumerate(self.settings):
            error, cost = (
                [v for v in column[i * views : (i + 1) * views] if v is not None] for column in (errors, costs)
            )
            if error and cost:
                worst = min(error) if self._more else max(error)
                found.append(Outcome(setting, worst, sum(cost) / len(cost)))
        return found

    @property
    def frontier(self) -> list[Outcome]:
        """The outcomes that no other beats in one of error and cost and equals in the other; the cheapest first."""
        best: list[Outcome] = []
        for outcome in sorted(self.outcomes, key=lambda each: (self._price(each), self._badness(each))):
            if not best or self._badness(outcome) < self._badness(best[-1]):
                best.append(outcome)
        return best

    def smallest(self, bound: float) -> Outcome | None:
        """The cheapest setting whose error is at most the bound in every view (of what is better the more: at least).

        None: there is none. Of settings that cost the same the more exact one, then the one that comes first.
        """
        return next((each for each in self.frontier if self._meets(each, bound)), None)

    def plot(self, path: str | PathLike[str] | None = None, bound: float | None = None) -> Figure:
        """Error against cost of all settings, the frontier as a line; with a bound the setting that meets it.

        path: of a PNG file. Notebooks show the figure. Needs matplotlib.
        """
        figure: Figure = needed("matplotlib.figure", "plots", EXTRA).Figure(figsize=(7.0, 4.5), layout="constrained")
        axes, frontier, all_ = figure.subplots(), self.frontier, self.outcomes
        axes.plot([o.cost for o in all_], [o.error for o in all_], ".", color="0.7", label=f"{len(all_)} settings")
        axes.plot(
            [o.cost for o in frontier], [o.error for o in frontier], "o-", ms=4, color="tab:blue", label="frontier"
        )
        if bound is not None:
            wanted = f"{self.error} {'>=' if self._more else '<='} {bound:g}"
            axes.axhline(bound, color="tab:red", lw=1, ls="--", label=wanted)
            chosen = self.smallest(bound)
            if chosen is not None:
                axes.plot([chosen.cost], [chosen.error], "o", ms=9, mfc="none", color="tab:red", label=str(chosen))
        axes.set_xlabel(f"{self.cost}, mean of the views: {self.measures[self.cost].meaning}", wrap=True)
        axes.set_ylabel(f"{self.error}, worst view")
        axes.set_title(f"{self.method}: {self.measures[self.error].meaning}", fontsize="medium", wrap=True)
        axes.legend(fontsize="small")
        if path is not None:
            with atomic(path) as file:
                figure.savefig(file, format="png", dpi=120, metadata={"Software": None})
        return figure

    @property
    def _more(self) -> bool:
        return self.measures[self.error].more

    def _badness(self, outcome: Outcome) -> float:
        return -outcome.error if self._more else outcome.error

    def _price(self, outcome: Outcome) -> float:
        return -outcome.cost if self.measures[self.cost].more else outcome.cost

    def _meets(self, outcome: Outcome, bound: float) -> bool:
        return outcome.error >= bound if self._more else outcome.error <= bound
