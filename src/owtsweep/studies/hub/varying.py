"""Computes the errors of all schemes and baselines over the values of one key, for `vary`.

The errors are expected ones (`studies.hub.expected`), of the settled part of a record.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from operator import attrgetter

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError, as_text, require
from owtsweep.io.terminal import tell_step
from owtsweep.results.conditions import Condition, Value
from owtsweep.results.status import OK
from owtsweep.statistics.contest import agree, group_coinciding
from owtsweep.studies.base.varying.errors import Errors
from owtsweep.studies.hub.bounds.kalman import kalman_bounds
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import BASELINES, list_baselines, resolve_all, scheme_names
from owtsweep.studies.hub.describe import list_sensors, make_cube, tell_not_asked, tell_window
from owtsweep.studies.hub.expected.answers import RESOLUTION, expect
from owtsweep.studies.hub.expected.engine import rows
from owtsweep.studies.hub.measures import criteria
from owtsweep.studies.hub.tuning_rules import RECORDED, RECORDED_FOR
from owtsweep.studies.hub.worlds import require_spectrum


def list_common_facts(configs: Sequence[HubConfig]) -> tuple[str, ...]:
    """Return the facts that hold for each configuration: tuning, sensors, truth."""
    listed = [
        [
            f"tuning {config.tuning_name}",
            *(f"{name} {value}" for name, value in list_sensors(config.sensors).items()),
            f"mean over all records of {config.record.duration:g} s, without the first "
            f"{config.measures.settling_time:g} s",
        ]
        for config in configs
    ]
    return tuple(fact for fact in listed[0] if all(fact in facts for facts in listed))


BOUND = (
    "The Kalman bound is the least error of an estimator that assumes nothing about the motion; an "
    "estimator that does assume something may have less."
)


def list_notes(
    along: Condition, configs: Mapping[Value, HubConfig], schemes: Sequence[str], mse: Array
) -> tuple[str, ...]:
    """Return sentences on coinciding schemes, HME2's numbers, bound, SKFA and the window."""
    groups = group_coinciding(schemes, lambda i, j: bool(agree(mse[i], mse[j]).all()))
    sentences = [f"{' and '.join(group)} have the same errors." for group in groups]
    recorded = [value for value, config in configs.items() if _has_recorded_numbers(config)]
    one_tuning = len({config.tuning_name for config in configs.values()}) == 1
    if RECORDED_FOR in schemes and one_tuning and 0 < len(recorded) < len(configs):
        places = " and ".join(along.show(value) for value in recorded)
        sentences.append(
            f"At {places}, {RECORDED_FOR} has the numbers that tuning=matched keeps for the "
            "paper's sensors; elsewhere its numbers follow a rule (docs/tuning.md)."
        )
    not_asked = tell_not_asked(next(iter(configs.values())))
    return (*sentences, BOUND, *not_asked, tell_window("settled"))


def _has_recorded_numbers(config: HubConfig) -> bool:
    return all(attrgetter(key)(config) == number for key, number in RECORDED.items())


#: The overrides that the command puts before the user's: a tuning whose numbers follow from the
#: sensors, and one motion in the middle of the grid, at which an estimator is needed.
DEFAULTS = [
    "tuning=matched", "engine=expected", "grid.natural_period=[4]", "grid.amplitude=[0.5]",
]  # fmt: skip
#: Computing time of a scheme and its part of the bound at one value, s, on one core of a server of
#: 2026: 12 s for four schemes and three baselines at two values, 17 s at five, with the start.
SECONDS = 0.4
#: Most motions (natural period and amplitude): each has a panel and a table of its own.
MOST_MOTIONS = 6
#: The part of a record whose error is compared: how an estimator starts is another question.
WINDOW = "settled"


def compute(along: Condition, configs: Mapping[Value, HubConfig]) -> Errors:
    """Compute the errors of all schemes and baselines, and the Kalman bound, at each value.

    `check` has passed the configurations. Raises InputError if a scheme cannot be computed.
    """
    one = next(iter(configs.values()))
    schemes, baselines, measures = scheme_names(one), list_baselines(one), criteria(one)
    periods = sorted(one.grid.natural_period)
    names, cubes, bounds = [*schemes, *baselines], [], []
    for number, (value, config) in enumerate(configs.items(), 1):
        place = f"{along.label}={along.show(value)}"
        tell_step(f"value {number} of {len(configs)}: {place}")
        cubes.append(
            make_cube(config, _compute_rows(config, names, periods, place), baselines=True)
        )
        bounds.append(kalman_bounds(config))
    mse, bound_mse = {}, {}
    for measure in measures:
        errors = [expect(cube, measure, WINDOW) for cube in cubes]
        mse[measure] = np.stack(errors, axis=1).reshape(len(names), len(cubes), -1)
        bound_mse[measure] = np.array([bound[measure] for bound in bounds])
    judged = mse[one.measures.criterion]
    notes = list_notes(along, configs, schemes, judged[: len(schemes)])
    motions = list(product(periods, sorted(one.grid.amplitude)))
    return make_errors(along, configs, motions, mse, bound_mse, notes)


def make_errors(
    along: Condition,
    configs: Mapping[Value, HubConfig],
    motions: Sequence[tuple[float, float]],
    mse: Mapping[str, Array],
    bounds: Mapping[str, Array],
    notes: Sequence[str] = (),
) -> Errors:
    """Return the errors by the criterion, with what table, figure and answer say of them.

    motions: Pairs of natural period (s) and amplitude (m).
    mse: Measure -> MSE, m^2 or (m/s)^2, shape (schemes and then baselines, values, motions).
    bounds: Measure -> Kalman bound of the MSE at each value, shape (values,).
    """
    one = next(iter(configs.values()))
    schemes, baselines = scheme_names(one), list_baselines(one)
    criterion = one.measures.criterion
    judged = mse[criterion]
    what = {"position": "position, x + y", "velocity": "velocity, vx + vy"}
    unit = "m/s" if criterion == "velocity" else "m"
    listed = "; ".join(f"{name}, {BASELINES[name].sentence}" for name in baselines)
    return Errors(
        along=along,
        values=tuple(configs),
        schemes=tuple(schemes),
        apart=tuple(baselines),
        cells=tuple(f"natural period {T:g} s, amplitude {N:g} m" for T, N in motions),
        title=f"rms error of {what.get(criterion, f'position, {criterion}')} ({unit})",
        unit=unit,
        error=np.sqrt(judged),
        best=_are_least(judged),
        best_scheme=_are_least(judged[: len(schemes)]),
        bound=np.sqrt(bounds[criterion]),
        facts=list_common_facts(list(configs.values())),
        notes=tuple(notes),
        footnotes=(f"Thin: baselines ({listed}).",) if baselines else (),
        table=_make_table(tuple(configs), [*schemes, *baselines], motions, mse, bounds),
    )


def _are_least(mse: Array) -> NDArray[np.bool_]:
    """Return who has the least MSE; several where the accuracy, `RESOLUTION`, cannot tell."""
    return np.asarray(mse <= (1.0 + RESOLUTION) * mse.min(axis=0))


def _make_table(
    values: Sequence[Value],
    names: Sequence[str],
    motions: Sequence[tuple[float, float]],
    mse: Mapping[str, Array],
    bounds: Mapping[str, Array],
) -> pd.DataFrame:
    """Make the table vary.csv: a row per value, scheme and motion."""
    places = product(enumerate(values), enumerate(names), enumerate(motions))
    return pd.DataFrame(
        {
            "value": value,
            "scheme": name,
            "natural_period": period,
            "amplitude": amplitude,
            **{f"mse_{measure}": every[s, v, m] for measure, every in mse.items()},
            **{f"bound_{measure}": bound[v] for measure, bound in bounds.items()},
        }
        for (v, value), (s, name), (m, (period, amplitude)) in places
    )


def check(along: Condition, configs: Mapping[Value, HubConfig]) -> None:
    """Check that the errors can be computed, and shown in one figure.

    Raises InputError if the configurations ask for records, for SKF, or for other motions, schemes
    or criteria than the first.
    """
    one = next(iter(configs.values()))
    for config in configs.values():
        require_spectrum(config, "`vary`")
        require(
            config.engine == "expected",
            f"engine: `vary` computes means over all records, and engine={config.engine} simulates "
            "records; leave out engine",
        )
        for scheme in resolve_all(config.schemes):
            require(
                not scheme.knows_motion,
                f"schemes: `vary` computes all amplitudes at once, and {scheme.name} has other "
                f"gains at each; leave {scheme.name} out, or use `sweep engine=expected "
                "measures.window=settled` for each value",
            )
        require(
            (config.grid, config.measures, config.schemes, config.baselines)
            == (one.grid, one.measures, one.schemes, one.baselines),
            f"{along.label}: its values differ in grid, measures, schemes or baselines, which "
            "`vary` needs to be the same; set those keys by overrides of their own",
        )
    count = len(one.grid.natural_period) * len(one.grid.amplitude)
    require(
        count <= MOST_MOTIONS,
        f"grid: {count} motions are too many for a figure; give at most {MOST_MOTIONS}, e.g. "
        "grid.natural_period=[4] grid.amplitude=[0.2,1]",
    )


def _compute_rows(
    config: HubConfig, names: Sequence[str], periods: Sequence[float], place: str
) -> pd.DataFrame:
    """Compute the rows of all schemes, on all cores; `place` says in messages which value it is."""

    def compute_one(name: str) -> pd.DataFrame:
        try:
            made = rows(config, name, periods)
        except Exception as error:  # a scheme of the user's may raise anything
            text = str(error) if isinstance(error, InputError) else as_text(error)
            raise InputError(f"schemes: {name} cannot be computed at {place}: {text}") from error
        require(
            bool((made["status"] == OK).all()),
            f"schemes: the error of {name} is not finite at {place}; leave out the scheme or the "
            "value",
        )
        return made

    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        return pd.concat(list(pool.map(compute_one, names)), ignore_index=True)
