"""The floater study as a declaration: from the motion of a basin's model to schemes' errors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import Plain
from owtsweep.evaluation.estimate import Reading
from owtsweep.io.reading import expand_home, hash_file
from owtsweep.studies.base.axes import Cell, Departure, Untold
from owtsweep.studies.base.declaration import Declaration, Quantity, Shown, Stated
from owtsweep.studies.base.schemes import Part
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.contest import CONTEST
from owtsweep.studies.floater.contract import DOF, Estimates, Measured, Setting
from owtsweep.studies.floater.measures import compare
from owtsweep.studies.floater.measuring import DRIFT_TIME, find_sigmas, measure, scale_accelerations
from owtsweep.studies.floater.motion_recorded import read_file
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.truth import Motion, make_truth

#: Most records of a block, and most samples of its records: it keeps their measurements. To write
#: and read the file of a block takes as long as a scheme takes for a record.
MOST_RECORDS, MOST_SAMPLES = 10, 500_000
#: Keys of the truth alone. The motion is left out: what schemes are told of it follows from the
#: motion itself.
UNTOLD = (
    "grid.delay", "grid.bias", "grid.snr", "grid.loss", "sensors.bias_drift",
    "sensors.process_snr", "sensors.loss_every", "sensors.loss_length", "sensors.jitter",
)  # fmt: skip
DEGREES = len(DOF)
#: Signals of `contract.Measured` -> their units.
SIGNALS = {
    "position": f"m and rad: {', '.join(DOF)}",
    "age": "s, of the position reported",
    "acceleration": "m/s^2 and rad/s^2",
    "rate": "rad/s",
    "specific_force": "m/s^2, in the frame of the body",
}
UNITS = {**SIGNALS, "velocity": "m/s and rad/s, derivatives of the position"}


class Record(NamedTuple):
    """How the structure moves in a record, and what its sensors say."""

    motion: Motion
    measured: Measured


def list_content(config: FloaterConfig) -> Plain:
    """Return what the rows of every block depend on; a file of motion by its bytes."""
    content = config.list_content()
    if config.motion.kind == "recorded":
        content["motion"]["file"] = hash_file(expand_home(str(config.motion.file)))
    return content


def make_setting(config: FloaterConfig, motion: Motion, cell: Cell) -> Setting:
    """Return what schemes know beforehand of a cell, by the section `filters`."""
    tuning, truth, body = config.filters, motion.truth, config.sensors.frame == "body"
    sigmas = find_sigmas(config, motion, cell["snr"])
    wrong = np.sqrt(cell["believed"])
    size = scale_accelerations(config, motion)
    noise = tuning.process_share * size if tuning.process == "declared" else sigmas.acceleration
    share = tuning.bias_share if tuning.bias == "ignored" else cell["bias"]
    drift = config.sensors.bias_drift if tuning.bias == "truth" else 0.0
    bias, walk = share * size, drift / np.sqrt(DRIFT_TIME) * size
    if body:  # angular accelerations are not measured: they are themselves the noise
        noise = np.concatenate(
            [noise, tuning.angular_share * truth.acceleration[:, 3:].std(axis=0)]
        )
        bias, walk = (np.concatenate([each, np.zeros(3)]) for each in (bias, walk))
    delay = {
        "ignored": 0.0,
        "declared": tuning.delay_declared,
        "truth": cell["delay"] * truth.step,
    }[tuning.delay]
    moved = [part.std(axis=0) for part in (truth.position, truth.velocity, truth.acceleration)]
    if config.motion.kind == "recorded":  # the frequency of zero crossings
        frequency = moved[1] / moved[0]
    else:
        periods = [config.motion.freedoms[name].resonance.period for name in DOF]
        frequency = 2.0 * np.pi / np.array(periods)
    return Setting(
        step=truth.step,
        position_sigma=wrong * sigmas.position,
        rate_sigma=wrong * sigmas.rate,
        acceleration_sigma=noise,
        bias_sigma=bias,
        bias_walk=walk,
        delay=delay,
        motion_sigma=np.stack(moved),
        frequency=frequency,
        body=body,
        zeros=config.sensors.lost_as == "zeros",
        tuning=tuning,
        start=np.stack([truth.position[0], truth.velocity[0]]) if tuning.start == "truth" else None,
    )


def _inform(
    config: FloaterConfig, cell: Cell, record: Record
) -> dict[str, Part[Setting, Measured]]:
    return {"": Part(make_setting(config, record.motion, cell), record.measured)}


def _score(
    config: FloaterConfig, cell: Cell, record: Record, parts: Mapping[str, Part[Setting, Measured]],
    estimates: Mapping[str, Estimates],
) -> dict[str, float]:  # fmt: skip
    sigma = parts[""].known.position_sigma / np.sqrt(cell["believed"])  # the true one
    return compare(record.motion.truth, estimates[""], sigma, config.record.settled)


def _show(config: FloaterConfig, cell: Cell, record: Record) -> Shown:
    truth, measured = record.motion.truth, record.measured
    time = truth.step * np.arange(len(truth.position))
    names = ("position", "velocity", "acceleration", "rate", "specific_force")
    signals = {name: getattr(measured, name) for name in SIGNALS}
    return Shown(
        time,
        config.record.settled,
        {name: getattr(truth, name) for name in names},
        {name: Reading(time, signal) for name, signal in signals.items() if signal is not None},
        UNITS,
    )


def _state(record: Record, estimates: Mapping[str, Estimates]) -> Stated:
    """Return position and velocity; covariances, (steps, 6, 6), are diagonal."""
    given = estimates[""]
    covariances: dict[str, Array] = {}
    if given.covariance is not None:
        for i, name in enumerate(("position", "velocity")):
            variance = given.covariance[:, :, i, i]
            covariances[name] = np.broadcast_to(
                variance[:, :, None] * np.eye(DEGREES), (len(given.position), DEGREES, DEGREES)
            )
    found = {"position": given.position, "velocity": given.velocity}
    return Stated(found, covariances, given.latency)


def _warn(config: FloaterConfig) -> None:
    if config.motion.kind == "recorded":
        read_file(config.motion).log_notes()


def list_untold(config: FloaterConfig) -> Untold:
    """Return what schemes are not told; a world that moves an axis of the map is none."""
    snr = config.grid.snr[0] - 6.0
    departures = {
        "jittering": Departure(
            "reports are late or early by half a sample", {"sensors.jitter": 0.5}
        ),
        "drifting": Departure(
            "biases drift by .3 of the accelerations' standard deviation in 100 s",
            {"sensors.bias_drift": 0.3},
        ),
        "losing": Departure("half a second is lost in every 10 s", {"sensors.loss_every": 10.0}),
        "late": Departure("reports come two samples late", {"grid.delay": 2.0}),
        "biased": Departure(
            "biases of .3 of the accelerations' standard deviation", {"grid.bias": 0.3}
        ),
        "noisy": Departure("twice the noise: 6 dB less", {"grid.snr": snr}),
    }
    return Untold(UNTOLD, departures).leave_out(config.axes)


DECLARATION = Declaration(
    axes=CONTEST,
    schemes=SCHEMES,
    list_content=list_content,
    most_records=lambda config: max(1, min(MOST_RECORDS, MOST_SAMPLES // config.record.steps)),
    make_truth=lambda config, cell, replicate: make_truth(config, replicate, cell.get("roll")),
    measure=lambda config, cell, motion: Record(motion, measure(config, motion, cell)),
    inform=_inform,
    score=_score,
    estimates={
        "position": Quantity((DEGREES,)),
        "velocity": Quantity((DEGREES,)),
        "nis": Quantity((DEGREES,), optional=True),
    },
    count_samples=lambda record: len(record.motion.truth.position),
    show=_show,
    state=_state,
    warn=_warn,
    list_untold=list_untold,
)
