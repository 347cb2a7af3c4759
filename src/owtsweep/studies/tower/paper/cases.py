"""Run the case studies of Simpson et al. (2025), section 5, with the tower study's own parts.

A sweep of the study has one set-up of sensors and one sea. The paper compares several, on the same
records; so its cases are run here, each from the configuration that the command `sweep` would take.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from time import perf_counter

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.streams import stream
from owtsweep.structures.stress import stress_matrix
from owtsweep.studies.composing import compose
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import DIRECTIONS, Estimates, Setting, Unable
from owtsweep.studies.tower.paper.setting import measure
from owtsweep.studies.tower.schemes import resolve
from owtsweep.studies.tower.schemes.filtered import Filtered, FilterScheme
from owtsweep.studies.tower.truth import Motion, make_truth

#: Noise of all sensors but GNSS, % of each signal's standard deviation (section 5.1.1).
NOISE = 1.0
#: Set-ups of Table 2 -> their names in figures.
SETUPS = {
    "dense_x_a": "Dense: x-a",
    "dense_theta_a": "Dense: θ-a",
    "sparse_theta_a": "Sparse: θ-a",
}


@dataclass(frozen=True)
class Case:
    """What is simulated, measured and estimated.

    Attributes
    ----------
    sensors, sea, tuning
        Files of conf/studies/tower.
    gravity
        Whether the truth is softened by its weight (p-delta).
    scheme
        "AKF" has the inputs p_1 (Eq. 34), "AKF_WAVE" p_2 (Eq. 35).
    """

    sensors: str = "sparse_theta_a"
    sea: str = "calm"
    gravity: bool = True
    scheme: str = "AKF"
    tuning: str = "paper"

    def compose(self, overrides: Sequence[str] = ()) -> TowerConfig:
        """Return the configuration of the case; `overrides` are Hydra's, e.g. of the record."""
        config = compose(
            [
                "study=tower",
                f"sensors={self.sensors}",
                f"sea={self.sea}",
                f"tuning={self.tuning}",
                f"truth.gravity={str(self.gravity).lower()}",
                "fatigue.curve=paper",
                f"grid.noise=[{NOISE}]",
                "grid.soil_factor=[1.0]",
                f"schemes=[{self.scheme}]",
                *overrides,
            ]
        )
        assert isinstance(config, TowerConfig)
        return config


@dataclass(frozen=True)
class Outcome:
    """One direction of a case on one record: what was, and what the estimator says.

    Attributes
    ----------
    case, direction, replicate
        Which case ("fa" or "ss"), and the number of its record.
    config, setting
        The configuration, and what the scheme was told.
    truth, estimates
        From the first sample on.
    stress
        Bending stress (Pa) at each node for unit degrees of freedom, shape (nodes, dof).
    seconds_per_step
        Computing time of the filter per sample of this direction.
    """

    case: Case
    direction: str
    replicate: int
    config: TowerConfig
    setting: Setting
    truth: Motion
    estimates: Estimates
    stress: Array
    seconds_per_step: float

    @property
    def judged(self) -> slice:
        """The samples that are judged."""
        return slice(self.config.record.settled, None)

    @property
    def time(self) -> Array:
        """Time from the beginning of the record in s, shape (steps,)."""
        return np.arange(len(self.truth.inputs)) * self.setting.step

    @property
    def heights(self) -> Array:
        """Heights of the nodes above the ground in m."""
        heights = self.setting.cut.heights
        return heights - heights[0]

    def find_node(self, height: float) -> int:
        """Return the number of the node nearest to a height above the ground."""
        return int(np.argmin(np.abs(self.heights - height)))

    def project(self, displacement: Array) -> Array:
        """Return the modal coordinates of displacements (steps, dof), shape (steps, modes)."""
        weights = self.setting.cut.mass @ self.setting.reduced.basis
        return np.asarray(displacement @ weights)


#: Outcomes of a case by direction.
Outcomes = dict[str, Outcome]


def run_cases(
    cases: Iterable[Case],
    replicate: int,
    overrides: Sequence[str] = (),
    tell: Callable[[str], None] = lambda text: None,
) -> dict[Case, Outcomes]:
    """Run cases on one record; cases of one sea and gravity have one truth.

    Parameters
    ----------
    cases
        What is simulated, measured and estimated.
    replicate
        Number of the record: which seeds of wind, waves and noise.
    overrides
        Overrides of the configuration for all cases, e.g. "record.duration=120".
    tell
        Called with the name of each step.
    """
    truths: dict[tuple[str, bool], dict[str, Motion]] = {}
    results = {}
    for case in cases:
        config = case.compose(overrides)
        key = (case.sea, case.gravity)
        if key not in truths:
            tell(f"record {replicate}: truth, {case.sea}{'' if case.gravity else ', no gravity'}")
            truths[key] = simulate(config, replicate)
        tell(f"record {replicate}: {case.scheme}, {case.sensors}, {case.sea}, {case.tuning}")
        results[case] = {
            direction: _estimate(case, config, truths[key][direction], direction, replicate)
            for direction in DIRECTIONS
        }
    return results


def streams(config: TowerConfig, replicate: int) -> Callable[[str], np.random.Generator]:
    """Return the function that gives the random streams of a record by name."""
    return partial(stream, config.seed, "tower", [], replicate)


def simulate(config: TowerConfig, replicate: int) -> dict[str, Motion]:
    """Simulate the whole structure; return its motion by direction."""
    return make_truth(
        config.structure,
        config.heights,
        config.wind,
        config.waves,
        streams(config, replicate),
        steps=config.record.steps,
        step=1.0 / config.record.rate,
        gravity=config.truth.gravity,
        subdivision=config.truth.subdivision,
    )


def _estimate(
    case: Case, config: TowerConfig, truth: Motion, direction: str, replicate: int
) -> Outcome:
    setting, measured = measure(config, truth, direction, replicate)
    scheme = resolve(case.scheme)
    try:
        prepared = scheme.prepare(setting)
    except Unable:
        # The paper judges a set-up that leaves bending unseen (accelerometers only) by its damage.
        if not isinstance(scheme, FilterScheme):
            raise
        model = scheme.model(setting)
        prepared = Filtered(model, scheme.tune(setting, model))
    begin = perf_counter()
    estimates = prepared.run(measured)
    seconds = (perf_counter() - begin) / len(measured)
    if not np.all(np.isfinite(estimates.displacement)):
        raise InputError(f"{case.scheme}: its estimates with {case.sensors} are not finite")
    stress = stress_matrix(config.structure, setting.cut)
    return Outcome(case, direction, replicate, config, setting, truth, estimates, stress, seconds)
