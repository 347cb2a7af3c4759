"""One record in time: what was, what the sensors said, and what the schemes made of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.streams import stream
from owtsweep.studies.hub import batch
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.records import STUDY, Records, make_records
from owtsweep.studies.hub.schemes import resolve_all

#: Natural period of the paper's time histories, section 5.2, s.
NATURAL_PERIOD = 3.8
#: Their amplitude (m) is not given. HME1 is better there, and at 4 s that begins at .3 m (section
#: 5.3): .5 m is the first amplitude of the study's grid above it.
AMPLITUDE = 0.5


@dataclass(frozen=True)
class Estimated:
    """One scheme over a record, NED.

    Attributes
    ----------
    position, velocity
        (steps, 2): estimate of step k at step k, m and m/s.
    acceleration, bias
        (steps, 2): the filter's states, m/s^2, of `lag` steps before; `acceleration` is None for
        a model without that state. `bias` is R b^b. NaN in the first `lag` steps.
    lag
        How many steps old acceleration and bias are when they become known.
    """

    position: Array
    velocity: Array
    acceleration: Array | None
    bias: Array
    lag: int


@dataclass(frozen=True)
class Histories:
    """A record of one natural period and amplitude, all series in NED.

    Attributes
    ----------
    natural_period, amplitude
        s, m.
    time
        (steps,) s.
    position, velocity, acceleration, bias
        (steps, 2): the truth.
    measured
        (steps, 2): the acceleration that the IMU reports, R f + g, m/s^2.
    fix_time, fixes
        (fixes,) s, when they arrive; (fixes, 2) m, the position of `delay` s before.
    delay
        Of the GNSS, s.
    integrated_position, integrated_velocity
        (steps, 2): the IMU alone, integrated from the true initial state.
    estimated
        Scheme -> its estimates.
    left_out
        Scheme -> why it could not run.
    """

    natural_period: float
    amplitude: float
    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    bias: Array
    measured: Array
    fix_time: Array
    fixes: Array
    delay: float
    integrated_position: Array
    integrated_velocity: Array
    estimated: dict[str, Estimated]
    left_out: dict[str, str]


def natural_period_of(config: HubConfig) -> float:
    """3.8 s, or the grid's period next to it where the spectrum is printed for whole seconds."""
    if config.spectrum.kind == "printed":
        return min(config.grid.natural_period, key=lambda period: abs(period - NATURAL_PERIOD))
    return NATURAL_PERIOD


def histories(
    config: HubConfig,
    *,
    natural_period: float | None = None,
    amplitude: float = AMPLITUDE,
    replicate: int = 0,
    schemes: tuple[str, ...] | None = None,
) -> Histories:
    """Run the schemes of a study over one record.

    Parameters
    ----------
    natural_period
        s; `natural_period_of(config)` by default.
    amplitude
        m.
    replicate
        Number of the record.
    schemes
        Names to run; all with a kernel by default. (Others take a Python loop of minutes.)
    """
    period = natural_period_of(config) if natural_period is None else natural_period
    records = make_records(config, period, [replicate])
    sensors, motion = records.sensors, records.motion[0]
    signal = [
        amplitude * np.outer(series, records.direction)
        for series in (motion.position, motion.velocity, motion.acceleration)
    ]
    force, fixes = batch.Lanes(records).at(amplitude)
    T = sensors.step
    measured = force + np.array(sensors.gravity)
    integrated_velocity = signal[1][0] + _before(np.cumsum(T * measured, axis=0))
    moved = T * integrated_velocity + 0.5 * T**2 * measured
    integrated_position = signal[0][0] + _before(np.cumsum(moved, axis=0))

    estimated: dict[str, Estimated] = {}
    left_out: dict[str, str] = {}
    for scheme in resolve_all(config.schemes, config):
        wanted = schemes is None or scheme.name in schemes
        if not (wanted and hasattr(scheme, "kernel")):
            continue
        try:
            chain = scheme.kernel(sensors, config, records.steps)
        except InputError as error:  # a tuning that this scheme cannot run with
            left_out[scheme.name] = str(error)
            continue
        estimated[scheme.name] = _estimate(chain, sensors, force, fixes)
    return Histories(
        natural_period=period,
        amplitude=amplitude,
        time=T * np.arange(records.steps),
        position=signal[0],
        velocity=signal[1],
        acceleration=signal[2],
        bias=_bias(config, records, replicate, period),
        measured=measured,
        fix_time=sensors.fix_step * np.arange(len(fixes)),
        fixes=fixes,
        delay=sensors.delay * T,
        integrated_position=integrated_position,
        integrated_velocity=integrated_velocity,
        estimated=estimated,
        left_out=left_out,
    )


def _before(sums: Array) -> Array:
    """Sums of all steps before each: what has been gathered when a step begins."""
    return np.concatenate([np.zeros((1, sums.shape[1])), sums[:-1]])


def _bias(config: HubConfig, records: Records, replicate: int, period: float) -> Array:
    """R b^b of one record: its noise once more, without all else."""

    def named(name: str) -> np.random.Generator:
        return stream(config.seed, STUDY, (period,), replicate, name)

    quiet = replace(records.sensors, force_sigma=0.0, gravity=(0.0, 0.0))
    alone = sensing.noise(config.sensors, quiet, records.steps, named)
    return np.asarray(alone.specific_force @ records.sensors.rotation.T)


def _estimate(chain: Chain, sensors: Sensors, force: Array, fixes: Array) -> Estimated:
    position, velocity, _ = batch.trajectories(chain, sensors, force, fixes)
    state = batch.states(chain, force, fixes)
    lag = chain.filter.input_delay + chain.filter.window
    state[:lag] = np.nan  # there is no such moment in the record
    has_acceleration = bool(np.any(chain.axis.force_row))
    return Estimated(
        position=position,
        velocity=velocity,
        acceleration=state[:, 2] if has_acceleration else None,
        bias=np.array(sensors.gravity) - state[:, 3],
        lag=lag,
    )
