"""The sections of the blade study's configuration that are its own."""

from __future__ import annotations

from typing import Annotated

from owtsweep.config import Axis, NotNegative, Positive, Section, key
from owtsweep.config.grid import Records
from owtsweep.studies.base.keys import Mode, key_of_vector, only_freedoms

#: Translations of the centre of gravity (longitudinal, lateral, vertical), then angles as the paper
#: has them: heading (positive clockwise seen from above), pitch, roll.
DOF = ("u", "v", "w", "heading", "pitch", "roll")


class Grid(Records):
    """The section `grid`: what is swept over; only the two of `axes` may have many values."""

    sigma: Axis[Positive] = key("standard deviation of a GNSS fix, horizontal", unit="m")
    outage: Axis[NotNegative] = key("length of an outage of GNSS", unit="s")
    offset: Axis[NotNegative] = key("by what the time stamps of GNSS come late", unit="s")
    period: Axis[Positive] | None = key(
        "natural period of the longitudinal swing; null: that of the motion", unit="s", default=None
    )
    amplitude: Axis[Positive] | None = key(
        "standard deviation of the longitudinal swing; null: that of the motion",
        unit="m",
        default=None,
    )
    lever: Axis[NotNegative] = key(
        "by how much the antenna stands elsewhere than assumed, in a random direction", unit="m"
    )
    heading: Axis[Positive] | None = key(
        "standard deviation of the heading; null: that of the motion", unit="deg", default=None
    )


class Freedom(Mode):
    """The motion of one degree of freedom: a resonance, and slow wandering in gusts."""

    sigma: NotNegative = key("standard deviation of the resonance, m or deg")
    gust: NotNegative = key("standard deviation of what gusts add, m or deg")


class Bending(Section):
    """The section `motion.bending`: by what the blade is not rigid; nothing unless it is set."""

    sag: NotNegative = key(
        "by how far the third prism, 28 m from the inertial unit, hangs below the rigid blade, "
        "under the blade's weight",
        unit="m",
        default=0.0,
        le=1.5,
    )
    vibration: NotNegative = key(
        "standard deviation of the vibration in the first flapwise mode there", unit="m",
        default=0.0, le=1.5,
    )  # fmt: skip
    period: Positive = key("natural period of that mode", unit="s", default=0.8)
    damping: Positive = key("damping ratio of that mode", default=0.01, lt=1.0)


class Tugger(Section):
    """The section `motion.tugger`: lines that hold the blade; none unless it is set."""

    heading: NotNegative = key(
        "stiffness that the lines add in heading, over that of the blade on its hook alone",
        default=0.0,
    )
    pitch: NotNegative = key("the same in pitch", default=0.0)
    damping: NotNegative = key(
        "damping ratio that the winches add to both, computed with the hook's stiffness alone",
        default=0.0,
    )


class Motion(Section):
    """The section `motion`: how the blade moves on its hook."""

    freedoms: Annotated[dict[str, Freedom], only_freedoms(DOF)] = key(
        "u, v, w, heading, pitch, roll: of the centre of gravity, and about it"
    )
    gust_time: Positive = key("time constant of gusts", unit="s")
    tugger: Tugger = key(
        "lines that hold heading and pitch; motion.freedoms is the motion without them",
        default=Tugger()
    )  # fmt: skip
    bending: Bending = key("how the blade bends beyond its root end", default=Bending())


class BoomMode(Mode):
    """One mode of the boom: the tip moves to and fro along a line."""

    sigma: list[float] = key_of_vector(
        "standard deviation of the tip along x, y and z; signs say along which line", "m"
    )


#: The modes of the boom unless others are given: sizes are like those of Fig. 13.
BOOM_MODES = {
    "aside": BoomMode(period=2.5, damping=0.01, sigma=[0.003, 0.0, 0.0]),
    "luffing": BoomMode(period=1.8, damping=0.01, sigma=[0.0, 0.002, 0.002]),
    "second": BoomMode(period=0.7, damping=0.01, sigma=[0.0005, 0.0002, -0.0002]),
}


class Boom(Section):
    """The section `boom`: how the tip of the crane's boom moves, and accelerometers on it."""

    modes: dict[str, BoomMode] = key(
        "name: period (s), damping and sigma (m, along x, y and z) of a mode of the boom",
        default=BOOM_MODES,
    )
    follow: list[NotNegative] = key_of_vector(
        "by what part the tip follows the blade's centre of gravity, along x, y and z",
        default=[0.01, 0.02, 0.3],
    )
    rate: Positive = key("rate of the accelerometers", unit="Hz", default=200.0)
    noise: NotNegative = key("white noise of their samples", unit="m/s^2", default=1.2e-4)
    bias: NotNegative = key("their bias", unit="m/s^2", default=0.05)


class Unit(Section):
    """The section `unit`: the inertial unit, set by unit=NAME, on an Earth that does not turn."""

    force_sigma: Positive = key("white noise of a sample of the accelerometers", unit="m/s^2")
    force_bias: NotNegative = key("bias of the accelerometers", unit="m/s^2")
    force_walk: NotNegative = key("change of that bias in 100 s", unit="m/s^2")
    rate_sigma: Positive = key("white noise of a sample of the gyroscopes", unit="deg/s")
    rate_bias: NotNegative = key(
        "bias of the gyroscopes; Earth's rotation is left out, so a recorded lift needs 0.0042 or "
        "more, which takes it up",
        unit="deg/s",
    )
    rate_walk: NotNegative = key("change of that bias in 100 s", unit="deg/s")
    tilt: Positive = key("error of pitch and roll with which a record begins", unit="deg")
    heading: Positive = key("error of the heading with which a record begins", unit="deg")


class Receiver(Section):
    """The section `sensors.receiver`: what GNSS adds to white noise; it strikes all antennas alike.

    An error that the hub's receiver shares need not be stated: it cancels between root and hub.
    """

    red_sigma: NotNegative = key(
        "standard deviation of slow errors, horizontal", unit="m", default=0.0
    )
    red_time: Positive = key("time constant of slow errors", unit="s", default=60.0)
    fixed_time: Positive | None = key(
        "mean time from a fixed solution to the next loss of ambiguities; null: never",
        unit="s",
        default=None,
    )
    float_time: Positive = key(
        "mean time until a float solution is fixed again", unit="s", default=20.0
    )
    float_sigma: NotNegative = key(
        "standard deviation of a float solution's slow error, horizontal", unit="m", default=0.3
    )
    jump_every: Positive | None = key(
        "mean time between jumps by reflected signals; null: none", unit="s", default=None
    )
    jump_sigma: NotNegative = key(
        "standard deviation of a jump, horizontal", unit="m", default=0.05
    )
    jump_time: Positive = key("how long a jump lasts", unit="s", default=5.0)


class Sensors(Section):
    """The section `sensors`: GNSS and total stations."""

    fix_rate: Positive = key("GNSS fixes per second", unit="Hz")
    vertical: Positive = key("vertical over horizontal standard deviation of a fix")
    receiver: Receiver = key(
        "errors of GNSS besides white noise, set by receiver=NAME", default=Receiver()
    )
    outage_every: Positive = key("time from the beginning of an outage to the next", unit="s")
    start_position: Positive = key("error of the position with which a record begins", unit="m")
    start_velocity: Positive = key("error of that velocity", unit="m/s")
    prism_sigma: Positive = key("noise of a total station", unit="m")
    prism_rate: Positive = key("prism positions per second, at irregular times", unit="Hz")
    prism_offset: NotNegative = key("by what the total stations' clock is late", unit="s")
    stretch: NotNegative = key(
        "by how much farther the first and the last prism are apart than assumed, along the "
        "blade, which bends under its weight",
        unit="m",
    )
