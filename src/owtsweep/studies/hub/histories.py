"""Simulates time histories of one record: true motion, measurements, every scheme's estimates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.results.conditions import Value
from owtsweep.studies.hub import estimates
from owtsweep.studies.hub.chain import Chain, bias_of, has_acceleration, lag_of
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve_all
from owtsweep.studies.hub.records import Records, make_records, make_records_at
from owtsweep.studies.hub.sensors import Sensors, simulate_bias
from owtsweep.studies.hub.worlds import PLANT, find_world

#: Natural period of the paper's time histories, section 5.2, s.
NATURAL_PERIOD = 3.8
#: Amplitude of these time histories, m. The paper does not print it, but HME1 is the better scheme
#: in them. At a natural period of 4 s, HME1 is better from 0.3 m on (section 5.3); 0.5 m is the
#: grid's next amplitude.
AMPLITUDE = 0.5
#: Sea state of the paper's time histories, figures 9-14 (its section 2).
SEA = {"hs": 2.0, "tp": 6.0}


@dataclass(frozen=True)
class SchemeHistory:
    """The estimates of one scheme over a record, in NED.

    values: quantity -> its estimates, shape (rows, 2). Position (m) and velocity (m/s) have a row
        per step. Row k of the filter's states, acceleration (if it is one) and bias R b^b (m/s^2),
        is for step k, made at step k + `lag`; the last `lag` steps of the record have none.
    """

    values: Mapping[str, Array]
    lag: int


@dataclass(frozen=True)
class Histories:
    """The time histories of one record; series are in NED and have the shape (steps, 2).

    natural_period, amplitude: s and m; of the plant those of the first mode and the largest
        displacement.
    time: of the steps, s, shape (steps,).
    truth: the true position (m), velocity (m/s), acceleration and bias R b^b of the IMU (m/s^2).
    measured: acceleration that the IMU reports, R f + g, m/s^2.
    fix_time, fixes: times at which fixes arrive, s, shape (fixes,), and the fixes, m, shape
        (fixes, 2).
    delay: of the GNSS, s.
    integrated: position (m) and velocity (m/s), integrated from `measured` and the true initial
        state.
    left_out: scheme -> why the scheme was not run.
    sea: the plant's conditions in words; "" with motion=spectrum.
    """

    natural_period: float
    amplitude: float
    time: Array
    truth: Mapping[str, Array]
    measured: Array
    fix_time: Array
    fixes: Array
    delay: float
    integrated: Mapping[str, Array]
    estimated: dict[str, SchemeHistory]
    left_out: dict[str, str]
    sea: str = ""


def natural_period_of(config: HubConfig) -> float:
    """Return 3.8 s as in Ren et al. (2019), or the grid's nearest period of a printed spectrum."""
    if config.spectrum.kind == "printed":
        return min(config.grid.natural_period, key=lambda period: abs(period - NATURAL_PERIOD))
    return NATURAL_PERIOD


def choose_sea(config: HubConfig, sea: Mapping[str, float] = SEA) -> dict[str, Value]:
    """Return the plant's conditions with the sea state nearest to `sea`: `hs` (m) and `tp` (s).

    Blades and friction angle are the first of the configuration.
    """
    grid = find_world(config).get_grid(config)
    nearest = {
        name: min(grid[name], key=lambda value: abs(float(value) - wanted))
        for name, wanted in sea.items()
    }
    return {name: values[0] for name, values in grid.items()} | nearest


def make_record(
    config: HubConfig, sea: Mapping[str, float]
) -> tuple[Records, float, float, dict[str, Value]]:
    """Return replicate 0, its natural period (s), the factor on its motion, and its conditions.

    There are conditions only with motion=plant; `sea` is as for `choose_sea`.
    """
    world = find_world(config)
    if world.has_spectrum:
        period = natural_period_of(config)
        return make_records(config, period, [0]), period, AMPLITUDE, {}
    conditions = choose_sea(config, sea)
    period = 1.0 / float(PLANT.make_source(config, conditions).vibration.frequency[0])
    return make_records_at(config, conditions, [0]), period, 1.0, conditions


def simulate_histories(config: HubConfig) -> Histories:
    """Simulate one record, run the configured schemes on it, and return the time histories.

    The record is replicate 0 at `AMPLITUDE` and the period of `natural_period_of`; with
    motion=plant it is that of the sea state nearest to `SEA`. Schemes without a kernel, and those
    that refuse the tuning, are listed in `left_out`.
    """
    records, period, factor, conditions = make_record(config, SEA)
    sensors, motion = records.sensors, records.motion[0]
    truth: dict[str, Array] = {
        quantity: factor * np.outer(getattr(motion, quantity), records.direction)
        for quantity in ("position", "velocity", "acceleration")
    }
    truth["bias"] = next(simulate_bias(config.sensors, sensors, records.steps, records.stream(0)))
    force, fixes = records.measure(factor)
    T = sensors.step
    measured = force + np.array(sensors.gravity)
    velocity = truth["velocity"][0] + _sum_before(T * measured)
    position = truth["position"][0] + _sum_before(T * velocity + 0.5 * T**2 * measured)

    estimated: dict[str, SchemeHistory] = {}
    left_out: dict[str, str] = {}
    for scheme in resolve_all(config.schemes, config):
        chained, loses = scheme.batched == "chain", config.sensors.gnss.loses
        try:
            # step by step it would take minutes
            require(chained, "it is none of the filter chains that this figure runs")
            require(not loses, "its gains depend on the fixes that are lost")
            chain = scheme.kernel(Known(sensors, config), records.steps)
        except InputError as error:  # perhaps a tuning that this scheme cannot run with
            left_out[scheme.name] = str(error)
        else:
            estimated[scheme.name] = _estimate(chain, sensors, force, fixes)
    return Histories(
        natural_period=period,
        amplitude=float(factor * np.abs(motion.position).max()) if conditions else AMPLITUDE,
        sea=find_world(config).describe_values(conditions) if conditions else "",
        time=T * np.arange(records.steps),
        truth=truth,
        measured=measured,
        fix_time=sensors.fix_step * np.arange(len(fixes)),
        fixes=fixes,
        delay=sensors.delay * T,
        integrated={"position": position, "velocity": velocity},
        estimated=estimated,
        left_out=left_out,
    )


def _sum_before(values: Array) -> Array:
    """Return running sums (steps, 2): row k is the sum of the values of the steps before k."""
    return np.pad(np.cumsum(values[:-1], axis=0), ((1, 0), (0, 0)))


def _estimate(chain: Chain, sensors: Sensors, force: Array, fixes: Array) -> SchemeHistory:
    lag = lag_of(chain)
    position, velocity, _ = estimates.trajectories(chain, force, fixes)
    state = estimates.states(chain, force, fixes)[lag:]  # the rows before are of earlier times
    values = {"position": position, "velocity": velocity, "bias": bias_of(state, sensors)}
    if has_acceleration(chain):
        values["acceleration"] = state[:, 2]
    return SchemeHistory(values, lag)
