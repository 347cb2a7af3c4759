"""Map which scheme bears which error of its model, with which sensors.

    python -m experiments.tower.model_errors [FOLDER] [RECORDS] [OVERRIDE ...]

FOLDER (default: results/tower_model_errors) gets model_errors.csv, the errors of all schemes, and
two maps: model_errors_damage.png and model_errors_base_moment.png. RECORDS is 2 by default (about a
minute each). An OVERRIDE is one of the tower study's keys, e.g. sea=waves; tuning=matched unless
another is given.

A sweep of the study has one set-up and one model. Here all are tried on the same records, so that a
map can say which scheme bears which error with which sensors.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import pandas as pd
from joblib import delayed
from matplotlib.figure import Figure

from experiments.command import compute, read_data, read_words, write
from experiments.simpson2025.scenarios import place_sensors
from owtsweep.figures import best_scheme_map, style
from owtsweep.io.terminal import show_steps
from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.conditions import Condition
from owtsweep.results.cube import Cube
from owtsweep.results.status import OK, UNABLE
from owtsweep.results.summary import summarise
from owtsweep.studies.base.contest import WINDOW
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.registry import compose
from owtsweep.studies.tower.case import Case, list_channels, make_case, measure
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contest import describe_truth
from owtsweep.studies.tower.measures import CRITERIA, compare
from owtsweep.studies.tower.schemes import SCHEMES
from owtsweep.studies.tower.setting import make_setting, model_substructure

#: What is wrong -> the override that makes it so.
ERRORS = read_data(__file__)
#: Files of conf/studies/tower/sensors.
SETUPS = ("dense_x_a", "dense_theta_a", "sparse_theta_a", "dry", "strain")
COMPARED = ("AKF", "AKF_LAGGED", "GDF", "AKF_WHOLE", "MDE")
MODEL_ERROR = Condition("model_error", "what is wrong in the schemes' model")
SENSORS = Condition("sensors", "sensors")
CONDITIONS = (SENSORS, MODEL_ERROR)
#: Noise of the sensors, % of each signal's standard deviation.
NOISE = 1.0


def collect(replicates: Sequence[int], overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Try all errors and set-ups on records with these numbers; return rows as those of a run.

    Records run side by side. `overrides` go to every configuration, e.g. "tuning=matched".
    """
    jobs = {
        f"record {n}: {len(ERRORS)} models, {len(SETUPS)} set-ups": delayed(_try_all)(n, overrides)
        for n in replicates
    }
    return pd.concat(compute(jobs), ignore_index=True)


def _try_all(replicate: int, overrides: Sequence[str]) -> pd.DataFrame:
    """Return the rows of one record."""
    first = _compose(SETUPS[0], ERRORS["none"], overrides)
    case = make_case(first, replicate)
    rows = []
    for sensors in SETUPS:
        for error, override in ERRORS.items():
            config = _compose(sensors, override, overrides)
            placed = place_sensors(config, case)
            wrong = replace(placed, part=model_substructure(config))
            for name in COMPARED:
                where = {"sensors": sensors, "model_error": error, "scheme": name,
                         "replicate": replicate}  # fmt: skip
                rows += [{**where, **row} for row in _try(config, wrong, name)]
    return pd.DataFrame(rows)


def _try(config: TowerConfig, case: Case, name: str) -> list[dict[str, object]]:
    """Return the rows of one scheme: damage and base moment, or why it is unable to work."""
    estimates = {}
    for direction in case.motion:
        channels = list_channels(config, case, direction, NOISE)
        measured = measure(config, case, direction, channels)
        try:
            motion = case.motion[direction]
            setting = make_setting(config, case.part, direction, 1.0, channels, motion)
            made = SCHEMES.resolve(name).prepare(setting)
        except Unable as reason:
            return [{"measure": "", "window": "", "value": float("nan"), "status": UNABLE,
                     "reason": str(reason)}]  # fmt: skip
        estimates[direction] = made.run(measured)
    found = compare(config, case.part, case.motion, case.fatigue, estimates)
    return [
        {"measure": key, "window": WINDOW, "value": found[key], "status": OK, "reason": ""}
        for key in ("damage", "base_moment")
    ]


def _compose(sensors: str, override: str, overrides: Sequence[str]) -> TowerConfig:
    config = compose(["study=tower", f"sensors={sensors}", *overrides, override])
    assert isinstance(config, TowerConfig)
    return config


def draw(cube: Cube, config: TowerConfig, records: int, criterion: str) -> Figure:
    """Draw the map of one criterion."""
    best = find_best_schemes(cube, WINDOW, {criterion: CRITERIA[criterion]})
    figure = best_scheme_map.draw(
        best, COMPARED, CONDITIONS, criterion=criterion,
        window=WINDOW, tuning=config.tuning_name, quantity=CRITERIA[criterion].title,
        records=f"{records} records per cell",
    )  # fmt: skip
    truth = f"Truth: {describe_truth(config)}; {NOISE:g} % noise, soil of the model right"
    style.add_origin(figure, f"{truth}; seed {config.seed}.")
    return figure


def main() -> None:
    """Try all errors and set-ups; write the table, and draw a map by each of two criteria."""
    folder, records, words = read_words("results/tower_model_errors", 2)
    overrides = ["tuning=matched", *words]
    config = compose(["study=tower", *overrides])
    with show_steps():
        rows = collect(range(records), overrides)
    cube = Cube.of_rows(
        rows, COMPARED, CONDITIONS, {"sensors": SETUPS, "model_error": list(ERRORS)},
        measures=["damage", "base_moment"],
    )  # fmt: skip
    maps = {
        f"model_errors_{criterion}": partial(draw, cube, config, records, criterion)
        for criterion in ("damage", "base_moment")
    }
    write(folder, {"model_errors": summarise(cube)}, maps)


if __name__ == "__main__":
    main()
