"""The Python interface: functions that do what the command line does, without a terminal."""

from __future__ import annotations

import os
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from owtsweep.errors import InputError, require
from owtsweep.studies import registry
from owtsweep.sweep.study import blame

if TYPE_CHECKING:
    from owtsweep.advice.advising import Advice
    from owtsweep.evaluation.estimate import EstimatedRecord
    from owtsweep.studies.hub.contract import Estimator
    from owtsweep.studies.replay.running import Replay
    from owtsweep.sweep.runs import Run

__all__ = ["advise", "estimate", "load", "online", "replay", "run"]

#: The sensors and the tuning of an estimator whose user names none.
DEFAULTS = ("tuning=matched", "sensors=strong_bias")


def run(overrides: Sequence[str] = ()) -> Run:
    """Run a study and return the run.

    If a run of the same configuration was interrupted, only what is missing is computed.
    `overrides` are Hydra's as on the command line, e.g. `["grid.replicates=2", "tuning=matched"]`.

    Returns: Its methods `cases()`, `summary()`, `best_scheme()`, and with the key `over` `regret()`
        return tables; `config` is its configuration. In `cases()`, the status is "failed" where a
        scheme failed, and "unable" where it cannot work under the conditions; the column `reason`
        says why.
    Raises InputError if an override is wrong. Nothing has been written in this case.

    >>> import owtsweep
    >>> run = owtsweep.run([
    ...     "grid.natural_period=[4]", "grid.amplitude=[0.5]", "grid.replicates=2",
    ...     "record.duration=60", "schemes=[MKF,HME1]",
    ... ])
    >>> run.best_scheme().set_index("criterion")["best"].to_dict()
    {'position': 'HME1', 'velocity': 'HME1'}
    """
    from owtsweep.sweep.run import sweep

    config = registry.compose(overrides)
    return sweep(registry.get_study(config.study), config).run


def advise(overrides: Sequence[str] = (), *, quick: bool = False) -> Advice:
    """Say which estimator to run in one case, how good it is, and what would change that.

    overrides: Hydra's as on the command line. An axis may stand without its section, e.g.
        `["natural_period=3.2", "amplitude=0.5", "sensors.gnss.rate=10"]`.
    quick: whether to leave out levers and other worlds.
    Returns: as text it is what the command prints; `as_plain()` returns its numbers as a dict.
    Raises InputError if an override is wrong, an axis has no value or several, or no scheme can
        work in this case.

    >>> import owtsweep
    >>> advice = owtsweep.advise([
    ...     "natural_period=4", "amplitude=0.5", "record.duration=100", "schemes=[MKF,HME1]",
    ... ], quick=True)
    >>> str(advice).splitlines()[0]
    'Asked: hub, natural period 4 s, amplitude 0.5 m, record.duration=100, schemes=[MKF,HME1].'
    """
    from owtsweep.advice.advising import Advice
    from owtsweep.advice.question import ask

    advice = Advice(ask(overrides))
    for _ in advice.tell(quick=quick):
        pass
    return advice


def load(path: str | PathLike[str]) -> Run:
    """Open the run in a folder, without importing or executing any code that the folder names.

    Raises InputError if the folder holds no run, or a run that this version of owtsweep cannot
        read.

    >>> import owtsweep
    >>> made = owtsweep.run([
    ...     "grid.natural_period=[4]", "grid.amplitude=[0.5]", "grid.replicates=1",
    ...     "record.duration=60", "schemes=[MKF]", "name=mine",
    ... ])
    >>> owtsweep.load("results/mine").config.schemes
    ['MKF']
    """
    from owtsweep.studies.opening import open_run

    require(isinstance(path, str | PathLike), f"path: {path!r} is no path; give that of a folder")
    return open_run(Path(os.path.expanduser(path)))


def estimate(overrides: Sequence[str] = (), replicate: int = 0) -> EstimatedRecord:
    """Make one record of a study, run all schemes of the configuration on it; write nothing.

    Truth and measurements are those of a sweep with the same configuration.

    overrides: Hydra overrides as on the command line, which leave one cell of the grid and one
        tuning, e.g. `["study=blade", "grid.sigma=[0.01]", "grid.outage=[20]", "schemes=[MEKF]"]`.
    replicate: Number of the record, from 0 on.
    Raises InputError if an override is wrong, several cells or tunings are left, or the study has
        no records of its own.

    >>> import numpy as np, owtsweep
    >>> record = owtsweep.estimate([
    ...     "study=floater", "grid.delay=[0]", "grid.bias=[0]", "schemes=[KF_REPAIRED]",
    ... ])
    >>> error = record.estimates["KF_REPAIRED"]["position"] - record.truth["position"]
    >>> error.shape, record.units["position"]
    ((10000, 6), 'm and rad: x, y, z, phi, theta, psi')
    """
    require(
        isinstance(replicate, int) and replicate >= 0,
        f"replicate: {replicate!r} is no number of a record; give 0, 1, ...",
    )
    config = registry.compose(overrides)
    study = registry.get_study(config.study)
    able = [name for name in registry.OURS if "estimate" in registry.get_study(name).commands]
    require(
        "estimate" in study.commands,
        f"study: {config.study!r} has no records of its own; use one of {', '.join(able)}",
    )
    config.require_one_tuning()
    with blame(study):
        return study.estimate(config, replicate)


def replay(files: str | PathLike[str] | Sequence[str], overrides: Sequence[str] = ()) -> Replay:
    """Run the schemes on recorded motion or recorded sensors.

    files: a path, a pattern such as "data/*.csv", or a list of paths and patterns. An empty list
        stands for the files of the table that the override `replay.table=FILE.csv` names.
    overrides: Hydra overrides as on the command line, e.g. `["columns.position_x=TwHt1TPxi",
        "sensors.gnss.rate=5"]`.
    Returns: Its methods `errors()`, `advice()`, `records()` and `estimates()` return DataFrames;
        its attribute `run` is the run. Of several records, those that cannot be used are left out;
        `refused()` lists them with the reason.
    Raises InputError if no file can be used, a file does not exist, or an override is wrong.
        Nothing has been written in this case.

    >>> import numpy as np, owtsweep, pandas as pd
    >>> time = np.arange(0.0, 60.0, 0.05)
    >>> record = pd.DataFrame({"time": time, "x": np.sin(1.5 * time), "y": 0.0 * time})
    >>> record.to_csv("hub.csv", index=False)
    >>> replay = owtsweep.replay("hub.csv", ["schemes=[MKF,HME1]"])
    >>> replay.advice()["recommended"].tolist()  # on the record, and on others like it
    ['HME1', 'HME1']
    """
    from owtsweep.studies.replay.running import Replay, configure, execute

    named = [files] if isinstance(files, str | PathLike) else files
    require(
        isinstance(named, Sequence) and all(isinstance(file, str | PathLike) for file in named),
        f"files: {files!r} is no path; give one, or a list of paths",
    )
    registry.require_texts(overrides)
    words = [str(file) for file in named]
    return Replay(execute(configure(words, overrides)).run)


def online(
    scheme: str, overrides: Sequence[str] = (), *, origin: ArrayLike | None = None
) -> Estimator:
    """Make an estimator that runs on board: each IMU sample gives one estimate.

    Its method is `update(specific_force, position=None) -> Estimate`. Position fixes may be
    missing: gains and covariances follow the fixes that arrived. On a machine, the first estimator
    takes some 15 s to make, in which its kernels are compiled.

    scheme: EKF, MKF, HME1, HME2, SKF, SKFA or SWITCH. SKF and SKFA need the origin, SKF the motion
        too: see the keys of the section `skf`.
    overrides: the sensors and the tuning, as on the command line, e.g. `["tuning=paper",
        "sensors.gnss.delay=0.3"]`. Without an override, the tuning is `matched`.
    origin: the point about which the scheme starts from zero, x and y in m, in the coordinates of
        the fixes; it must lie near the hub. None stands for the first fix: until it comes,
        estimates are NaN. Estimates are in the coordinates of the fixes for any origin.
    Raises InputError if the scheme cannot run on board, or the overrides or the origin are wrong.

    >>> import owtsweep
    >>> estimator = owtsweep.online("MKF", ["sensors.gnss.rate=2"], origin=(0.0, 0.0))
    >>> estimate = estimator.update([0.1, 0.0], [1.0, 2.0])  # with a fix
    >>> estimate = estimator.update([0.1, 0.0])  # without one
    >>> estimate.position.round(2)
    array([1., 2.])
    """
    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.studies.hub.contract import Known, resolve
    from owtsweep.studies.hub.sensors import sensors

    registered = resolve(scheme)
    if not registered.on_board:
        raise InputError(
            f"scheme: {scheme!r} has no online form; use EKF, MKF, HME1, HME2, SKF, SKFA or SWITCH"
        )
    registry.require_texts(overrides)
    given = {override.partition("=")[0] for override in overrides}
    ours = [word for word in DEFAULTS if word.partition("=")[0] not in given]
    config = registry.compose([*ours, *overrides, f"schemes=[{scheme}]"])
    if not isinstance(config, HubConfig):
        raise InputError(f"study: {config.study!r} has no schemes to run online; use study=hub")
    return registered.stream(Known(sensors(config.sensors), config), origin)
