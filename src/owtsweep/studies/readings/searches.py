"""Search for the best parameters; all trials of a search use the same records.

A target says what to search: the parameters, the schemes and the kind of score. A trial is one set
of values of the parameters. For the kind "published" a trial is a reading of the paper, i.e. a
choice of the values that the paper leaves open. The score is then the distance of the results from
the paper's results (`readings.score`). For the kind "settled" the score is the settled
position MSE. All trials are kept, including bad trials.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from owtsweep.comparing.comparison import flatten
from owtsweep.config import Plain, as_mapping, conf_directory, require, with_values
from owtsweep.config.stored import read
from owtsweep.studies.base.searching import require_cmaes, search
from owtsweep.studies.readings.config import ReadingsConfig
from owtsweep.studies.readings.score import PERIODS, make_lanes, score_published, score_settled
from owtsweep.sweep.study import FAILED, OK, Block

#: Columns of every trial besides its parameters.
COLUMNS = (
    "target", "truth", "search", "trial", "score", "median_log2", "p80_log2", "winners",
    "boundary_4s", "boundary_6s", "boundary_8s", "n_parameters", "status", "reason",
)  # fmt: skip

#: Folder of tunings as they were when searches were recorded.
FROZEN = Path(__file__).parent / "tunings"

#: Kind of a target -> what judges its trials.
JUDGES = {"published": score_published, "settled": score_settled}

#: Keys that do not belong to a search's content: they change no number, or the target sets them.
_NOT_SHARED = ReadingsConfig.inert - {"study", "config_version"} | {"calibration", "schemes"}

#: The score in the table of a trial that diverges.
DIVERGED = 50.0


def plan(config: ReadingsConfig) -> list[Block]:
    """Return the blocks of the study: one search per target, truth and sampler seed.

    A truth is a set of overrides, e.g. of the sensors' true errors, under which a target is
    searched. A target of kind "settled" has a single truth. Raise `InputError` if the sampler
    CMA-ES is not installed, or if a target has an unknown kind, truth, tuning or key.
    """
    require_cmaes()
    calibration = config.calibration
    shared = {key: value for key, value in as_mapping(config).items() if key not in _NOT_SHARED}
    blocks = []
    for name, target in calibration.targets.items():
        kind = str(target.get("kind"))
        require(
            kind in JUDGES,
            f"calibration.targets.{name}.kind: {kind!r} is none of {', '.join(JUDGES)}",
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

    A target of kind "settled" has one truth, "own". Another may list names of `truths`, or has all.
    Raise `InputError` if the target lists an unknown truth.
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
    Raise `InputError` if there is no tuning file of this name.
    """
    folders = (conf_directory() / "tuning", FROZEN)
    files = {path.stem: path for folder in folders for path in sorted(folder.glob("*.yaml"))}
    require(name in files, f"tuning: there is no {name!r}; use {' or '.join(files)}")
    return flatten(read(files[name], resolve=False))


def take_fixed_values(target: Plain, default: str) -> dict[str, object]:
    """Return dotted key -> value of a target's tuning file (else `default`) that is not searched.

    The searched keys are left out, so that a search stays valid after its result has been written
    into the tuning file.
    """
    searched = {key for keys in target["parameters"] for key in keys.split("+")}
    sections = {name.lower() for name in target["schemes"]} | {"hme"}
    values = read_tuning(str(target.get("tuning", default)))
    return {
        key: value
        for key, value in values.items()
        if key.split(".")[0] in sections
        and key not in searched
        # a filter that assumes no tilt is one of the time before filters had the key
        and not (key.endswith(".tilt") and value == 0.0)
    }


def run(config: ReadingsConfig, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run the search of each block; yield the block and a table with one row per trial."""
    for block in blocks:
        yield block, _search(config, block)


def _search(config: ReadingsConfig, block: Block) -> pd.DataFrame:
    content = block.content
    target = content["target"]
    base = with_values(config, {**target["values"], **content["truth"]})
    replicates = range(content["replicates"])  # every trial is judged on the same records
    periods = PERIODS if target["kind"] == "published" else base.grid.natural_period
    lanes = make_lanes(base, replicates, periods)

    def objective(chosen: Plain) -> tuple[float, Plain]:
        values = {key: value for keys, value in chosen.items() for key in keys.split("+")}
        tried = with_values(base, values)
        own_records = tried.sensors != base.sensors  # what the sensors are is a parameter
        records = make_lanes(tried, replicates, periods) if own_records else lanes
        return JUDGES[target["kind"]](tried, target["schemes"], records)

    trials = search(
        target["parameters"], objective,
        trials=content["trials"], seed=content["sampler_seed"], starts=[target["start"]],
        near_start=True,
    )  # fmt: skip
    names = (content["target_name"], content["truth_name"], content["sampler_seed"])
    rows = [
        {
            "target": names[0],
            "truth": names[1],
            "search": "/".join(map(str, names)),
            "trial": number,
            "score": trial.score if np.isfinite(trial.score) else DIVERGED,
            "winners": "",
            "n_parameters": len(trial.values),
            "status": FAILED if trial.reason else OK,
            "reason": trial.reason,
            **trial.values,
            **trial.details,
        }
        for number, trial in enumerate(trials)
    ]
    table = pd.DataFrame(rows)
    return table.reindex(columns=[*COLUMNS, *(c for c in table.columns if c not in COLUMNS)])
