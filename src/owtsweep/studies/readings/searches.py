"""Search with Optuna for the best parameters; all trials of a search use the same records.

A target says what to search: the parameters, the schemes and the kind of score. A trial is one set
of values of the parameters. For the kind "published" a trial is a reading of the paper, i.e. a
choice of the values that the paper leaves open. The score is then the distance of the results from
the paper's results (`readings.score`). For the kind "settled" the score is the settled
position MSE. All trials are kept, including bad trials.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from owtsweep.comparing.comparison import flatten
from owtsweep.config import as_mapping, conf_directory, require, with_values
from owtsweep.config.stored import read
from owtsweep.errors import InputError, as_text
from owtsweep.studies.hub.public import Lanes
from owtsweep.studies.readings.config import Plain, ReadingsConfig
from owtsweep.studies.readings.score import (
    BOUNDED,
    at_amplitude,
    compare,
    make_lanes,
    scheme_products,
    score,
)
from owtsweep.sweep.study import FAILED, OK, Block

if TYPE_CHECKING:
    import optuna

#: Columns of every trial besides its parameters.
COLUMNS = (
    "target", "truth", "search", "trial", "score", "median_log2", "p80_log2", "winners",
    "boundary_4s", "boundary_6s", "boundary_8s", "n_parameters", "status", "reason",
)  # fmt: skip

#: Folder of tunings as they were when searches were recorded.
FROZEN = Path(__file__).parent / "tunings"

KINDS = ("published", "settled")

#: Initial standard deviation of the optimizer CMA-ES, as a fraction of each parameter's range.
SPREAD = 0.03

#: Keys that do not belong to a search's content: they change no number, or the target sets them.
_NOT_SHARED = ReadingsConfig.inert - {"study", "config_version"} | {"calibration", "schemes"}

#: The score of a trial that diverges.
DIVERGED = 50.0


def plan(config: ReadingsConfig) -> list[Block]:
    """Return the blocks of the study: one search per target, truth and sampler seed.

    A truth is a set of overrides, e.g. of the sensors' true errors, under which a target is
    searched. A target of kind "settled" has a single truth.

    Raises
    ------
    InputError
        If the sampler CMA-ES is not installed, or if a target has an unknown kind, truth, tuning or
        key.
    """
    _require_cmaes()
    calibration = config.calibration
    shared = {key: value for key, value in as_mapping(config).items() if key not in _NOT_SHARED}
    blocks = []
    for name, target in calibration.targets.items():
        kind = str(target.get("kind"))
        require(
            kind in KINDS,
            f"calibration.targets.{name}.kind: {kind!r} is none of {', '.join(KINDS)}",
        )
        values = take_fixed_values(target, config.tuning_name)
        truths = _choose_truths(name, target, calibration.truths)
        for truth, overrides in truths.items():
            # refuses an unknown key before anything runs
            with_values(config, {**values, **overrides})
            for seed in calibration.sampler_seeds:
                label = f"{name}, {truth}, sampler seed {seed}"
                content = {
                    "config": shared,
                    "target": {**target, "values": values},
                    "target_name": name,
                    "truth": dict(overrides),
                    "truth_name": truth,
                    "sampler_seed": seed,
                    "trials": calibration.trials,
                    "replicates": calibration.replicates,
                }
                blocks.append(Block(label, label, content, calibration.trials))
    return blocks


def _choose_truths(name: str, target: Plain, truths: Mapping[str, Plain]) -> Mapping[str, Plain]:
    """Return a target's truths: name -> overrides under which the target is searched.

    Parameters
    ----------
    name, target
        Name of the target, and the target: an entry of the key `calibration.targets`. A target of
        kind "settled" has a single truth, called "own". Another target may list names of truths in
        `truths`; without such a list it has all truths.
    truths
        All truths: the value of the key `calibration.truths`.

    Raises
    ------
    InputError
        If the target lists an unknown truth.
    """
    if target["kind"] == "settled":
        return {"own": target.get("truth", {})}
    wanted = target.get("truths", list(truths))
    for truth in wanted:
        require(
            truth in truths,
            f"calibration.targets.{name}.truths: there is no {truth!r} in calibration.truths; use "
            f"{', '.join(truths)}",
        )
    return {truth: truths[truth] for truth in wanted}


def read_tuning(name: str) -> dict[str, object]:
    """Read the tuning file `conf/tuning/<name>.yaml`; return its values by dotted key.

    A file of that name in the folder `FROZEN` comes first: a recorded search stays what it was.

    Raises
    ------
    InputError
        If there is no tuning file of this name.
    """
    folders = (conf_directory() / "tuning", FROZEN)
    files = {path.stem: path for folder in folders for path in sorted(folder.glob("*.yaml"))}
    require(name in files, f"tuning: there is no {name!r}; use {' or '.join(files)}")
    return flatten(read(files[name], resolve=False))


def take_fixed_values(target: Plain, default: str) -> dict[str, object]:
    """Return the values of a target's schemes that are not searched, from the target's tuning file.

    The searched keys are left out, so that a search stays valid after its result has been written
    into the tuning file.

    Parameters
    ----------
    target
        An entry of the key `calibration.targets`.
    default
        Name of the tuning file for a target that names none.

    Returns
    -------
    dict
        Dotted key -> value.
    """
    searched = {key for keys in target["parameters"] for key in keys.split("+")}
    sections = {name.lower() for name in target["schemes"]} | {"hme"}
    values = read_tuning(str(target.get("tuning", default)))
    return {
        key: value
        for key, value in values.items()
        if key.split(".")[0] in sections
        and key not in searched
        # a filter that believes in no tilt is one of the time before filters had the key
        and not (key.endswith(".tilt") and value == 0.0)
    }


def _require_cmaes() -> None:
    try:
        import cmaes  # noqa: F401  (Optuna's CMA-ES sampler needs it)
    except ImportError as error:
        raise InputError(
            f"experiment=readings: {error.name} is missing; install owtsweep[calibrate]"
        ) from error


def run(config: ReadingsConfig, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run the search of each block; yield the block and a table with one row per trial."""
    for block in blocks:
        yield block, _search(config, block)


def _search(config: ReadingsConfig, block: Block) -> pd.DataFrame:
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    content = block.content
    target = content["target"]
    base = with_values(config, {**target["values"], **content["truth"]})
    replicates = range(content["replicates"])  # every trial is judged on the same records
    if target["kind"] == "settled":
        judge, periods = _score_settled, {"periods": base.grid.natural_period}
    else:
        judge, periods = _score_published, {}
    lanes = make_lanes(base, replicates, **periods)
    study = optuna.create_study(sampler=_make_sampler(target, content["sampler_seed"]))
    study.enqueue_trial(dict(target["start"]))
    search = f"{content['target_name']}/{content['truth_name']}/{content['sampler_seed']}"
    rows: list[dict[str, object]] = []

    def objective(trial: optuna.Trial) -> float:
        chosen = {key: suggest(trial, key, bounds) for key, bounds in target["parameters"].items()}
        row: dict[str, object] = {
            "target": content["target_name"],
            "truth": content["truth_name"],
            "search": search,
            "trial": trial.number,
            "n_parameters": len(chosen),
            "winners": "",
            "status": OK,
            "reason": "",
            **chosen,
        }
        try:
            values = {key: value for keys, value in chosen.items() for key in keys.split("+")}
            tried = with_values(base, values)
            anew = tried.sensors != base.sensors  # what the sensors are is a parameter
            records = make_lanes(tried, replicates, **periods) if anew else lanes
            found, details = judge(tried, target["schemes"], records)
            found = found if np.isfinite(found) else DIVERGED
            row |= details
        except (InputError, ArithmeticError, np.linalg.LinAlgError) as error:
            found = DIVERGED
            row |= {"status": FAILED, "reason": as_text(error)}
        rows.append(row | {"score": found})
        return found

    study.optimize(objective, n_trials=content["trials"])
    table = pd.DataFrame(rows)
    return table.reindex(columns=[*COLUMNS, *(c for c in table.columns if c not in COLUMNS)])


def _make_sampler(target: Plain, seed: int) -> optuna.samplers.BaseSampler:
    """Make the Optuna sampler of a search: TPE if a parameter has a list of options, else CMA-ES.

    CMA-ES begins at the target's start values. It finds better scores in these searches, but works
    with numbers only.

    Parameters
    ----------
    target
        An entry of the key `calibration.targets`.
    seed
        Seed of the sampler.
    """
    import optuna

    if any(isinstance(bounds, Mapping) for bounds in target["parameters"].values()):
        return optuna.samplers.TPESampler(seed=seed, multivariate=True)
    with warnings.catch_warnings():
        # Optuna 6 drops x0 and sigma0; the extra `calibrate` asks for an earlier version.
        warnings.simplefilter("ignore", FutureWarning)
        return optuna.samplers.CmaEsSampler(x0=dict(target["start"]), sigma0=SPREAD, seed=seed)


def suggest(
    trial: optuna.Trial, key: str, bounds: Sequence[object] | Mapping[str, Sequence[object]]
) -> object:
    """Ask Optuna for the value of one parameter in a trial, and return the value.

    Parameters
    ----------
    trial
        The trial (`optuna.Trial`).
    key
        Name of the parameter.
    bounds
        A list [low, high, scale] with the scale "linear", "log" or "int", or a mapping whose key
        `options` lists the values to choose from.
    """
    if isinstance(bounds, Mapping):
        return trial.suggest_categorical(key, list(bounds["options"]))
    low, high, scale = bounds
    if scale == "int":
        return trial.suggest_int(key, low, high)
    return trial.suggest_float(key, low, high, log=scale == "log")


def _score_settled(
    config: ReadingsConfig, schemes: Sequence[str], lanes: Mapping[float, Lanes]
) -> tuple[float, dict[str, object]]:
    """Compute the score of a trial for a target of kind "settled"; there are no details."""
    settled = with_values(config, {"measures.window": "settled"})
    logs = []
    for scheme in schemes:
        for products in scheme_products(settled, scheme, lanes).values():
            position = products[:2].sum(axis=0)
            logs += [np.log(at_amplitude(position, N)) for N in config.grid.amplitude]
    return float(np.exp(np.mean(logs))), {}


def _score_published(
    config: ReadingsConfig, schemes: Sequence[str], lanes: Mapping[float, Lanes]
) -> tuple[float, dict[str, object]]:
    """Compute the score of a trial for a target of kind "published"; return it with its details.

    The score is the mean of |log2(reproduced / published)| over the published numbers of the
    schemes. If the schemes include HME1 and HME2, penalties are added for wrong best schemes and
    wrong boundaries. A boundary is the amplitude at which HME1 and HME2 have equal errors.

    Parameters
    ----------
    config
        The configuration with the parameters' values in this trial.
    schemes
        Names of the schemes to judge.
    lanes
        Natural period in s -> the simulated records.
    """
    products = {scheme: scheme_products(config, scheme, lanes) for scheme in schemes}
    logs = compare(products).log2.abs()
    found = float(logs.mean())
    details: dict[str, object] = {
        "median_log2": float(logs.median()),
        "p80_log2": float(logs.quantile(0.8)),
    }
    if {*BOUNDED} <= {*schemes}:
        all_four = score(products)
        found += all_four.penalties
        details["winners"] = " ".join(all_four.winners)
        for period in (4.0, 6.0, 8.0):
            details[f"boundary_{period:g}s"] = all_four.boundaries[period]
    return found, details
