"""Choose what to recommend: the simplest of those schemes and baselines that are not worse.

The order of simplicity is NONE, HOLD, DELTA, EKF and MKF, HME1, HME2, then schemes of a user. A
scheme or baseline is worse if its error is larger than the least error by a difference that
matters: by `LEAST_MARGIN` at least, with a 95 % interval above zero, or by `LARGE_MARGIN`. So a
scheme is not recommended where a baseline has less error. Where a scheme and a baseline cannot be
told apart, the baseline is recommended.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from owtsweep.arrays import Array
from owtsweep.statistics.inference import mean_and_error, t_quantile
from owtsweep.studies.hub.public import BASELINES

#: A margin (an error / the least error - 1) below this does not matter for the choice.
LEAST_MARGIN = 0.05
#: A margin of at least this matters even if the interval holds zero. The errors of a gap of fixes
#: lie in one part of a record, and make the interval wide whatever the mean says.
LARGE_MARGIN = 1.0
#: With fewer pairs than this, an interval says too little, and only the margin decides.
FEWEST_PAIRS = 5
#: Name -> place in the order of simplicity; other schemes come after these.
SIMPLICITY = {"NONE": 0, "HOLD": 1, "DELTA": 2, "EKF": 3, "MKF": 3, "HME1": 4, "HME2": 5}
#: The map advises for a record only if the fitted spectrum covers this share of its variance. A
#: curve of the right shape covers 0.87, and a curve fitted to one of two equal peaks some 0.56.
LEAST_COVERED = 0.6

#: Columns that the table of advice has for the choice.
COLUMNS = (
    "recommended", "value_recommended", "baseline", "value_baseline", "baseline_difference",
    "baseline_ci_low", "baseline_ci_high", "fit_share", "advises", "contradicts_record",
)  # fmt: skip


def recommend(
    samples: Array, names: Sequence[str], best: str, *, whole: Array | None = None
) -> dict[str, object]:
    """Choose the simplest of the schemes and baselines that are not worse than another.

    Parameters
    ----------
    samples
        Mean squared errors in n replicates or n parts of a record, shape (schemes and baselines,
        n); NaN where there is no value. Those are compared that have every value which the best
        scheme has.
    names
        Names of schemes and baselines. A name may be there twice; the first one counts.
    best
        The scheme of the least error.
    whole
        The mean squared errors of the whole record, shape (schemes and baselines,). If None, the
        means of the samples.

    Returns
    -------
    dict
        The columns `COLUMNS` of the table of advice up to `baseline_ci_high`. `baseline` is what is
        recommended if that is a baseline, otherwise the baseline of the least error; without
        baselines it is "", and the numbers on it are left out. `baseline_difference` is the best
        scheme's error minus that of the baseline, so it is positive where the baseline is better.
    """
    at_best = list(names).index(best)
    common = np.isfinite(samples[at_best])
    able = [
        i
        for i, name in enumerate(names)
        if names.index(name) == i and np.all(np.isfinite(samples[i, common]))
    ]
    means = np.mean(samples[:, common], axis=1) if whole is None else whole
    least = min(able, key=lambda i: means[i])
    good = [i for i in able if not _is_worse(samples[:, common], means, i, least)]
    chosen = min(good, key=lambda i: (SIMPLICITY.get(names[i], len(SIMPLICITY)), -i))
    row: dict[str, object] = {
        "recommended": names[chosen],
        "value_recommended": float(means[chosen]),
        "baseline": "",
    }
    rivals = [i for i in able if names[i] in BASELINES]
    if not rivals:
        return row
    rival = chosen if chosen in rivals else min(rivals, key=lambda i: means[i])
    difference, half = _compare(samples[:, common], means, at_best, rival)
    return row | {
        "baseline": names[rival],
        "value_baseline": float(means[rival]),
        "baseline_difference": difference,
        "baseline_ci_low": difference - half,
        "baseline_ci_high": difference + half,
    }


def _is_worse(samples: Array, means: Array, one: int, other: int) -> bool:
    """Say whether the error of `one` is larger than that of `other` by a difference that matters.

    `one` and `other` are rows of `samples` and places in `means`.
    """
    difference, half = _compare(samples, means, one, other)
    if difference == 0.0 or not difference >= LEAST_MARGIN * means[other]:
        return False
    few = samples.shape[1] < FEWEST_PAIRS
    return few or bool(difference > half or difference >= LARGE_MARGIN * means[other])


def _compare(samples: Array, means: Array, one: int, other: int) -> tuple[float, float]:
    """Return the error of `one` minus that of `other`, and half the 95 % interval of its mean.

    The half is NaN for a single sample.
    """
    _, error, n = mean_and_error(samples[one] - samples[other])
    half = float(t_quantile(n - 1) * error) if n > 1 else np.nan
    return float(means[one] - means[other]), half


def relate_to_record(
    values: Mapping[str, float], by_record: Mapping[str, object] | None, share: float
) -> dict[str, object]:
    """Say whether the expected map advises for a record, and whether it contradicts the record.

    Parameters
    ----------
    values
        Name of a scheme or baseline -> its error by the expected map.
    by_record
        The row of the table of advice by the record's own errors; None if there is none.
    share
        The share of the record's variance that the fitted spectrum covers.

    Returns
    -------
    dict
        The columns fit_share, advises and contradicts_record of the table of advice. The map
        contradicts the record if what the record recommends has, by the map, an error that is
        larger than the least one by `LEAST_MARGIN` or more.
    """
    contradicts = False
    chosen = "" if by_record is None else str(by_record["recommended"])
    if chosen in values:
        least = min(values.values())
        contradicts = values[chosen] - least >= LEAST_MARGIN * least > 0.0
    return {
        "fit_share": share,
        "advises": bool(share >= LEAST_COVERED),
        "contradicts_record": bool(contradicts),
    }
