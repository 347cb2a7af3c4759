"""What the compared runs have in common: cells, schemes, criterion, and whether noise is paired."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from owtsweep.config import changed, require
from owtsweep.results import aggregate
from owtsweep.studies.hub import scheme_names
from owtsweep.studies.hub.config import HubConfig
from owtsweep.sweep.comparison import Candidate, Comparison

if TYPE_CHECKING:
    import pandas as pd

#: What the motion of a record hangs on besides its natural period and replicate.
PAIRING = ("seed", "record", "spectrum", "band", "normalise")


@dataclass(frozen=True)
class Common:
    """What all runs have: natural periods (s), amplitudes (m), schemes, the criterion."""

    natural_periods: list[float]
    amplitudes: list[float]
    schemes: list[str]
    criterion: str
    notes: list[str]

    @property
    def cells(self) -> list[tuple[float, float]]:
        """(natural period, amplitude) of every common cell."""
        return [(T, N) for T in self.natural_periods for N in self.amplitudes]


def common(comparison: Comparison) -> Common:
    """What the runs have in common.

    Raises
    ------
    InputError
        If they share no cell or no scheme, are judged by different criteria, or if some of them
        are expectations and others are not.
    """
    configs: list[HubConfig] = [run.config for run in comparison.runs]
    expectations = {config.engine == "expected" for config in configs}
    require(
        len(expectations) == 1,
        "engine: some runs are of engine=expected, which has no records to pair with those of the "
        "others; compare runs of records with each other, and expected ones with each other",
    )
    criteria = list(dict.fromkeys(config.measures.criterion for config in configs))
    require(
        len(criteria) == 1,
        f"measures.criterion: the runs are judged by {' and '.join(criteria)}, which are no one "
        "quantity; compare runs of one criterion",
    )
    lists: dict[str, list[list[float]]] = {
        "grid.natural_period": [config.grid.natural_period for config in configs],
        "grid.amplitude": [config.grid.amplitude for config in configs],
    }
    notes = []
    if expectations == {True}:
        notes.append(
            "engine=expected has no records: n is 0, nothing has an interval, and no change is "
            "called established"
        )
    shared = {}
    for key, axes in lists.items():
        shared[key] = sorted(set(axes[0]).intersection(*axes[1:]))
        require(bool(shared[key]), f"{key}: the runs have no value in common; run common ones")
        if any(set(axis) != set(shared[key]) for axis in axes):
            kept = ", ".join(f"{value:g}" for value in shared[key])
            notes.append(f"{key} differs between the runs; compared is what all have: {kept}")
    names = [scheme_names(config) for config in configs]
    schemes = [name for name in names[0] if all(name in other for other in names)]
    require(bool(schemes), "schemes: the runs have no scheme in common; run common ones")
    left_out = sorted({name for own in names for name in own} - set(schemes))
    if left_out:
        notes.append(f"schemes that not all runs have are left out: {', '.join(left_out)}")
    periods, amplitudes = shared.values()
    return Common(periods, amplitudes, schemes, criteria[0], notes)


def best_of(run: Candidate, values: pd.DataFrame, shared: Common) -> pd.DataFrame:
    """The best scheme of every common cell, as the run's own best_scheme.csv tells it."""
    config: HubConfig = run.config
    if config.engine != "expected":
        return aggregate.best_scheme(
            values, shared.schemes, config.measures.window, criteria=[shared.criterion]
        )
    from owtsweep.studies.hub.expected.answers import best_scheme

    rows = run.rows[run.rows["natural_period"].isin(shared.natural_periods)]
    grid = changed(config.grid, amplitude=shared.amplitudes)
    return best_scheme(changed(config, grid=grid), rows, shared.schemes, [shared.criterion])


def values_of(run: Candidate, shared: Common) -> pd.DataFrame:
    """The values (`aggregate.VALUE_COLUMNS`) of one run in the common cells."""
    values = aggregate.expand(run.rows, shared.amplitudes)
    keep = values["natural_period"].isin(shared.natural_periods)
    keep &= values["scheme"].isin(shared.schemes)
    return values[keep].reset_index(drop=True)


def samples_of(
    values: pd.DataFrame, shared: Common, window: str, replicates: Sequence[int]
) -> pd.DataFrame:
    """MSE by the criterion: rows (scheme, natural period, amplitude), columns replicates.

    NaN where a scheme did not finish a replicate; m^2 (or m^2/s^2 for velocities).
    """
    import pandas as pd

    used = values[(values["measure"] == shared.criterion) & (values["window"] == window)]
    axes = ["scheme", "natural_period", "amplitude"]
    table = used.pivot(index=axes, columns="replicate", values="value")
    product = pd.MultiIndex.from_product(
        [shared.schemes, shared.natural_periods, shared.amplitudes], names=axes
    )
    return table.reindex(index=product, columns=list(replicates)).astype(float)


def unpaired_keys(one: HubConfig, other: HubConfig) -> list[str]:
    """The keys that differ and give two runs different motions; empty if they are paired.

    Sigma, delay, rate, bias and tuning keep the phases of the motion and the draws of the noise.
    """
    return [key for key in PAIRING if getattr(one, key) != getattr(other, key)]
