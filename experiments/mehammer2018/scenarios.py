"""Run the tests of Mehammer et al. (2018), section 3, with the floater study's own parts.

A sweep of the study has one truth and one way of losses. The paper compares several, so its tests
are run here, each from the configuration that the command `sweep` would take.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from experiments.command import read_data
from owtsweep.arrays import Array
from owtsweep.motion.lines import Series
from owtsweep.studies.base.schemes import Ready
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.contest import CONTEST
from owtsweep.studies.floater.contract import Estimates, Measured, Setting, Truth
from owtsweep.studies.floater.declaration import make_setting
from owtsweep.studies.floater.measuring import measure
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.truth import Motion, make_truth
from owtsweep.studies.registry import compose

#: Sensors and start of the paper's tests with virtual data (section 3.1): accelerations have no
#: noise, the estimator begins at the truth, and the noise of positions refers to the mean square.
VIRTUAL = ("sensors.power=square", "sensors.exact_inertial=true", "filters.start=truth")


@dataclass(frozen=True)
class Scenario:
    """What moves, what is measured, and who estimates.

    Attributes
    ----------
    schemes
        Names of the schemes that run on the same records.
    tuning, motion
        Files of conf/studies/floater.
    snr, delay, believed
        The cell: signal-to-noise ratio in dB, delay in samples, believed over true variance.
    words
        Further overrides of the configuration.
    printed
        Whether the truth is the paper's kinematic model: accelerations that are held over a step,
        integrated (Eqs. 6 to 9), which the printed filters know exactly.
    """

    schemes: Sequence[str]
    tuning: str = "matched"
    motion: str = "floater"
    snr: float = 20.0
    delay: float = 0.0
    believed: float = 1.0
    words: Sequence[str] = ()
    printed: bool = False

    def compose(self, overrides: Sequence[str] = ()) -> FloaterConfig:
        """Return the configuration of the scenario; `overrides` are Hydra's, e.g. of the record."""
        cell = (
            f"study=floater motion={self.motion} tuning={self.tuning} axes=[snr,delay] "
            f"grid.bias=[0] grid.snr=[{self.snr}] grid.delay=[{self.delay}] "
            f"grid.believed=[{self.believed}] schemes=[{','.join(self.schemes)}]"
        )
        virtual = VIRTUAL if self.printed else ()
        config = compose([*cell.split(), *virtual, *self.words, *overrides])
        assert isinstance(config, FloaterConfig)
        return config


#: The paper's tests, and what the project's own goals are judged by: name -> scenario.
PAPER, OWN = (
    {name: Scenario(**fields) for name, fields in part.items()}
    for part in read_data(__file__).values()
)


@dataclass(frozen=True)
class Outcome:
    """A scenario on one record: what was, what was measured, and what one scheme says."""

    scenario: Scenario
    scheme: str
    config: FloaterConfig
    setting: Setting
    prepared: Ready[Measured, Estimates]
    truth: Truth
    measured: Measured
    estimates: Estimates

    @property
    def time(self) -> Array:
        """Time from the beginning of the record in s, shape (steps,)."""
        return self.truth.step * np.arange(len(self.truth.position))

    @property
    def settled(self) -> int:
        """The first sample that is judged."""
        return self.config.record.settled


def run_scenario(
    scenario: Scenario, replicate: int, overrides: Sequence[str] = ()
) -> dict[str, Outcome]:
    """Run a scenario on the record with a number; return scheme -> outcome."""
    return run_composed(scenario, scenario.compose(overrides), replicate)


def run_composed(scenario: Scenario, config: FloaterConfig, replicate: int) -> dict[str, Outcome]:
    """Run a scenario, of which `config` is the configuration, on the record with a number."""
    (cell,) = CONTEST.list_cells(config)
    motion = make_truth(config, replicate, cell.get("roll"))
    if scenario.printed:
        motion = integrate_as_printed(motion)
    measured = measure(config, motion, cell)
    setting = make_setting(config, motion, cell)
    outcomes = {}
    for scheme in scenario.schemes:
        prepared = SCHEMES.resolve(scheme).prepare(setting)
        estimates = prepared.run(measured)
        outcomes[scheme] = Outcome(
            scenario, scheme, config, setting, prepared, motion.truth, measured, estimates
        )
    return outcomes


def integrate_as_printed(motion: Motion) -> Motion:
    """Return the motion that the paper's kinematic model makes of a motion's accelerations.

    Accelerations are held over a step (Eq. 9). Before the record it is the motion itself.
    """
    lead, truth = motion.lead, motion.truth
    start = np.stack([truth.position[0], truth.velocity[0]])
    position, velocity = integrate(start, truth.acceleration, truth.step)
    series = Series(
        np.concatenate([motion.series.position[:lead], position]),
        np.concatenate([motion.series.velocity[:lead], velocity]),
        motion.series.acceleration,
    )
    return replace(
        motion, truth=replace(truth, position=position, velocity=velocity), series=series
    )


def integrate(start: Array, acceleration: Array, step: float) -> tuple[Array, Array]:
    """Return positions and velocities (steps, n) by X(k+1) = A_d X(k) + B_d U(k), Eq. (9).

    Parameters
    ----------
    start
        Position and velocity at sample 0, shape (2, n).
    acceleration
        Shape (steps, n).
    step
        In s.
    """
    held = acceleration[:-1]
    velocity = np.concatenate([start[1:], start[1] + step * np.cumsum(held, axis=0)])
    moved = step * velocity[:-1] + 0.5 * step**2 * held
    return np.concatenate([start[:1], start[0] + np.cumsum(moved, axis=0)]), velocity
