"""What is the floater study's own in the contest of its schemes: axes, criteria, a run in words."""

from __future__ import annotations

from owtsweep.motion.recorded import tell_alone
from owtsweep.results.conditions import Condition
from owtsweep.studies.base.contest import Contest, Costs, tell_single
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.measures import CRITERIA, MEASURES

#: The axes that the grid may have, of which a map shows two.
CONDITIONS = (
    Condition("delay", "delay of the optical system", "samples", plural="delays", enters="sensors"),
    Condition(
        "bias", "bias of accelerometers over standard deviation", plural="biases", enters="sensors"
    ),
    Condition("snr", "signal-to-noise ratio", "dB", enters="sensors"),
    Condition("loss", "share of reports lost", plural="shares of reports lost", enters="sensors"),
    Condition("believed", "believed over true variance of noise", scale="log", enters="knowledge"),
    Condition("roll", "standard deviation of roll", "deg", scale="log"),
)
#: Values of axes of which nothing needs to be said.
USUAL = {"delay": 0.0, "bias": 0.0, "loss": 0.0, "believed": 1.0}
#: Kind of a simulated motion -> what is said of it.
MOTIONS = {
    "synthetic": "synthetic motion, resonances of {}, waves of {:g} s",
    "decay": "decay motion, release, natural periods {}",
}
#: Keys of the section `sensors` -> what is said if they are set.
SENSORS = {
    "exact_inertial": "accelerations without noise",
    "bias_drift": "drift {:g} in 100 s",
    "optical_rate": "reports at {:g} Hz",
    "jitter": "jitter {:g} of a sample",
}


def describe_truth(config: FloaterConfig) -> str:
    """Return the motion and the length of the records in words."""
    record, motion = config.record, config.motion
    if motion.kind == "recorded":
        words = tell_alone(str(motion.file))
    else:
        slow = sorted({freedom.resonance.period for freedom in motion.freedoms.values()})
        periods = f"{slow[0]:g} to {slow[-1]:g} s" if len(slow) > 1 else f"{slow[0]:g} s"
        words = MOTIONS[motion.kind].format(periods, motion.wave_period)
    return f"{words}; {record.duration:g} s at {record.rate:g} Hz"


def describe_sensors(config: FloaterConfig) -> str:
    """Return in words what sensors do, the axes that have one value among it."""
    sensors, parts = config.sensors, tell_single(CONDITIONS, config, USUAL)
    parts.append("accelerometers fixed to the body" if sensors.frame == "body" else "global frame")
    if sensors.sigma is not None:
        noise = ", ".join(f"{sigma:g}" for sigma in sensors.sigma)
        parts.append(f"noise of positions in m and deg {noise}")
    elif sensors.power == "square":
        parts.append("noise to the mean square")
    given = {key: getattr(sensors, key) for key in SENSORS}
    parts += [words.format(given[key]) for key, words in SENSORS.items() if given[key]]
    if sensors.loss_every is not None:
        parts.append(f"{sensors.loss_length:g} s lost every {sensors.loss_every:g} s")
    parts.append("lost reports arrive as zeros" if sensors.lost_as == "zeros" else "losses missing")
    return ", ".join(parts)


#: Measured on one core of a server of 2026, 500 s at 20 Hz.
COSTS = Costs(
    record=2.0e-6,
    schemes={
        "KF_STEADY": 1.5e-6, "KF": 1.3e-6, "KF_CONSISTENT": 1.5e-6, "KF_BIAS": 1.5e-6,
        "KF_DELAY": 1.8e-6, "KF_REPAIRED": 1.8e-6, "ERROR_STATE": 2.2e-6,
        "PASSIVE_OBSERVER": 1.1e-6, "COMPLEMENTARY": 1.1e-6, "LOWPASS": 1.3e-6, "FIXED_LAG": 2.9e-6,
    },
    memory=320e6,
)  # fmt: skip

CONTEST = Contest(
    conditions=CONDITIONS,
    criteria=CRITERIA,
    measures=MEASURES,
    describe_truth=describe_truth,
    describe_sensors=describe_sensors,
    # keys of sensors scale noise, and move or leave out reports, but draw no other numbers
    pairing=("seed", "record", "motion"),
    costs=COSTS,
)
