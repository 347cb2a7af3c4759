"""Turn outcomes of the paper's case studies into numbers, one row per record and quantity."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
import pandas as pd
from joblib import delayed

from experiments.command import compute
from experiments.simpson2025.scenarios import ALL, Outcome, run_scenarios
from owtsweep.arrays import Array
from owtsweep.evaluation.signals import (
    compute_frac,
    compute_mae,
    compute_rms_error,
    compute_trac,
    divide_by_deviation,
    find_lag,
)
from owtsweep.structures.fatigue import compute_damage
from owtsweep.studies.tower.contract import INPUTS

#: Heights above the ground (m) of the states that the paper compares (section 5.3.1).
STATE_HEIGHTS = (0, 15)
#: Band about the first tower mode in Hz, in which spectra are compared.
FIRST_MODE = (0.13, 0.20)
#: Length in s of the pieces of a record of which a spectrum is the mean.
PIECE = 200.0
#: Welds with less than this part of the largest damage are not judged.
NEGLIGIBLE = 0.01
#: Length in s at both ends of what is judged, over which drift is measured.
ENDS = 100.0


def collect(replicates: Sequence[int], overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Run all scenarios on records with these numbers; return the scores.

    They are those of `tabulate` and `judged_damage_ratio` (see `add_judged_welds`). Records run
    side by side, in as many processes as there are cores; each needs up to 1 GB.
    """
    jobs = {f"record {n}: judged": delayed(_score)(n, overrides) for n in replicates}
    return add_judged_welds(pd.concat(compute(jobs), ignore_index=True))


def _score(replicate: int, overrides: Sequence[str]) -> pd.DataFrame:
    """Return the scores of one record; estimates of one scenario at a time are in memory."""
    runs = run_scenarios(ALL, replicate, overrides)
    return pd.concat([tabulate(outcomes.values()) for _, outcomes in runs], ignore_index=True)


def tabulate(outcomes: Iterable[Outcome]) -> pd.DataFrame:
    """Return the numbers of outcomes in a table.

    Columns: sensors, sea, gravity, weight, scheme, tuning, direction, replicate, quantity, measure,
    value.
    Units are SI; damages are those of the judged part of a record.
    """
    rows = []
    for outcome in outcomes:
        case = outcome.scenario
        where = {
            "sensors": case.sensors, "sea": case.sea, "gravity": case.gravity,
            "weight": case.weight, "scheme": case.scheme, "tuning": case.tuning,
            "direction": outcome.direction, "replicate": outcome.replicate,
        }  # fmt: skip
        for quantity, measure, value in _measure(outcome):
            rows.append({**where, "quantity": quantity, "measure": measure, "value": value})
    return pd.DataFrame(rows)


def add_judged_welds(scores: pd.DataFrame) -> pd.DataFrame:
    """Return scores with the measure `judged_damage_ratio`: `damage_ratio` where damage counts.

    It counts at welds with more than 1 % of the largest damage of their scenario and direction, in
    the mean over the records.
    """
    case = [name for name in scores if name not in ("replicate", "quantity", "measure", "value")]
    damage = scores[scores["measure"] == "damage"]
    means = damage.groupby([*case, "quantity"])["value"].mean()
    counts = means > NEGLIGIBLE * means.groupby(case).transform("max")
    ratios = scores[scores["measure"] == "damage_ratio"]
    judged = ratios.join(counts.rename("counts"), on=[*case, "quantity"])["counts"]
    added = ratios[judged].assign(measure="judged_damage_ratio")
    return pd.concat([scores, added], ignore_index=True)


def states_of(outcome: Outcome) -> dict[str, tuple[Array, Array]]:
    """Return true and estimated x0, theta0, x15 and theta15, by name, over the judged samples."""
    truth, estimate = outcome.truth.displacement, outcome.estimates.displacement
    result = {}
    for height in STATE_HEIGHTS:
        dof = 2 * outcome.find_node(height)
        for name, at in ((f"x{height}", dof), (f"theta{height}", dof + 1)):
            result[name] = truth[outcome.judged, at], estimate[outcome.judged, at]
    return result


def damages_of(outcome: Outcome) -> tuple[Array, Array]:
    """Return true and estimated damage at each node, shape (nodes,) each."""
    fatigue = outcome.config.fatigue
    curves = fatigue.find_curves(outcome.setting.cut.heights)
    true, estimated = (
        compute_damage(
            displacement[outcome.judged] @ outcome.stress.T, curves, fatigue.ultimate_strength
        )
        for displacement in (outcome.truth.displacement, outcome.estimates.displacement)
    )
    return true, estimated


def find_density(signal: Array, step: float) -> tuple[Array, Array]:
    """Return frequencies in Hz and the power spectral density of a signal, by Welch's method."""
    from scipy.signal import welch

    pieces = min(round(PIECE / step), len(signal))
    frequency, density = welch(signal, 1.0 / step, nperseg=pieces, detrend="constant")
    return np.asarray(frequency), np.asarray(density)


def _measure(outcome: Outcome) -> Iterator[tuple[str, str, float]]:
    """Yield quantity, measure and value for everything that is judged of an outcome."""
    for name, (true, estimated) in states_of(outcome).items():
        yield from _compare(name, true, estimated)
        yield from _follow_drift(name, estimated - true, outcome.setting.step)
    judged, step = outcome.judged, outcome.setting.step
    for column, name in enumerate(INPUTS):
        true, estimated = (
            inputs[judged, column] for inputs in (outcome.truth.inputs, outcome.estimates.inputs)
        )
        yield from _compare(name, true, estimated)
        yield name, "lag", float(find_lag(true, estimated, step, longest=2.0))
        yield name, "offset", float(np.mean(estimated - true))
        yield name, "mean", float(np.mean(true))
        yield from _compare_spectra(name, true, estimated, step)
    yield from _compare_modes(outcome)
    true, estimated = damages_of(outcome)
    large = true > NEGLIGIBLE * true.max()
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = estimated / true
    for height, d, r in zip(outcome.heights, true, ratio, strict=True):
        yield f"z={height:g}", "damage", float(d)
        yield f"z={height:g}", "damage_ratio", float(r)
    # The factor by which the worst weld is over- or underestimated: 1.1 is 10 % either way.
    with np.errstate(divide="ignore"):
        off = np.maximum(ratio[large], 1.0 / ratio[large])
    yield "welds", "worst_deviation", float(np.abs(ratio[large] - 1.0).max())
    yield "welds", "worst_factor", float(off.max())
    yield "filter", "seconds_per_step", outcome.seconds_per_step
    yield "filter", "unseen", float(outcome.unseen)


def _compare(name: str, true: Array, estimated: Array) -> Iterator[tuple[str, str, float]]:
    yield name, "trac", float(compute_trac(true, estimated))
    yield name, "trac_centred", float(compute_trac(true, estimated, centred=True))
    yield name, "frac", float(compute_frac(true, estimated))
    mae = compute_mae(true, estimated)
    yield name, "mae", float(mae)
    yield name, "relative_mae", float(divide_by_deviation(mae, true))
    yield name, "sigma", float(np.std(true))


def _follow_drift(name: str, error: Array, step: float) -> Iterator[tuple[str, str, float]]:
    """Yield the rms error in the first and in the last part of what is judged."""
    count = min(round(ENDS / step), len(error) // 2)
    yield name, "early_error", float(np.sqrt(np.mean(error[:count] ** 2)))
    yield name, "late_error", float(np.sqrt(np.mean(error[-count:] ** 2)))


def _compare_spectra(
    name: str, true: Array, estimated: Array, step: float
) -> Iterator[tuple[str, str, float]]:
    frequency, of_truth = find_density(true, step)
    _, of_estimate = find_density(estimated, step)
    band = (frequency >= FIRST_MODE[0]) & (frequency <= FIRST_MODE[1])
    if not band.any():
        return
    yield name, "mode_ratio", float(np.sqrt(of_estimate[band].sum() / of_truth[band].sum()))
    peaks = [frequency[band][np.argmax(density[band])] for density in (of_truth, of_estimate)]
    yield name, "mode_shift", float(abs(peaks[1] - peaks[0]))


def _compare_modes(outcome: Outcome) -> Iterator[tuple[str, str, float]]:
    """Yield errors of the coordinates of the reduced model, by kind of mode."""
    kinds = np.array(outcome.setting.reduced.kinds)
    true, estimated = (
        outcome.project(displacement[outcome.judged])
        for displacement in (outcome.truth.displacement, outcome.estimates.displacement)
    )
    error = compute_rms_error(true, estimated)
    rigid = kinds == "rigid"
    yield "modes", "rigid_error", float(error[rigid].max())
    yield "modes", "other_error", float(error[~rigid].max())
    yield "modes", "least_trac", float(compute_trac(true, estimated)[~rigid].min())
    yield "modes", "normal_trac", float(compute_trac(true, estimated)[kinds == "normal"].min())
