"""The configuration of the floater study: its keys, types, bounds and meanings."""

from __future__ import annotations

from typing import Annotated, Literal

from owtsweep.config import Axis, Finite, NotNegative, Positive, Section, key
from owtsweep.config.grid import Records
from owtsweep.studies.base import keys
from owtsweep.studies.floater.contract import DOF
from owtsweep.studies.floater.tuning import Tuning


class Grid(Records):
    """The section `grid`: what is swept over; only the two of `axes` may have many values."""

    delay: Axis[NotNegative] = key("delay of the optical system", unit="samples")
    bias: Axis[NotNegative] = key(
        "bias of the accelerometers, as a part of the acceleration's standard deviation"
    )
    snr: Axis[Finite] = key("signal-to-noise ratio of all sensors", unit="dB")
    loss: Axis[NotNegative] = key("share of optical reports that is lost")
    believed: Axis[Positive] = key("variance R that schemes assume, over the true one")
    roll: Axis[Positive] | None = key(
        "standard deviation of the roll angle; null: that of the motion", unit="deg", default=None
    )


class Resonance(keys.Mode):
    """A narrow resonance of one degree of freedom."""

    sigma: NotNegative = key("standard deviation, m or deg")


class Freedom(Section):
    """The motion of one degree of freedom."""

    mean: Finite = key("mean, m or deg")
    resonance: Resonance = key("the slow part")
    waves: NotNegative = key("standard deviation of the wave-frequency part, m or deg")


class Motion(Section):
    """The section `motion`: what moves, set by motion=NAME."""

    kind: Literal["synthetic", "decay", "recorded"] = key("where the motion is from")
    freedoms: Annotated[dict[str, Freedom], keys.only_freedoms(DOF)] = key(
        "x, y, z, phi, theta, psi: the motion of each; with kind=decay the standard deviation is "
        "the deflection at the release"
    )
    wave_period: Positive = key("peak period of the waves", unit="s")
    wave_gamma: float = key("peak enhancement of their JONSWAP spectrum", ge=1.0)
    surge_pitch: float = key(
        "correlation of pitch with surge, and of roll with minus sway", ge=-1.0, le=1.0
    )
    attitude: Literal["small", "exact"] = key(
        "how body rates and specific force follow from angles: to first order, or by Eq. 2"
    )
    file: str | None = key("table with kind=recorded (docs/recorded.md); null: none", default=None)
    columns: list[str] = key(
        "SIGNAL:NAME where a column has another name, SIGNAL:NAME:UNIT where its unit is another, "
        "e.g. [x:SURGE,phi:ROLL:deg]",
        default=[],
    )


class Sensors(Section):
    """The section `sensors`: the optical system and the inertial unit."""

    frame: Literal["global", "body"] = key(
        "accelerations of all six in the basin's frame (section 2.3), or sensors fixed to the body"
    )
    power: Literal["variance", "square"] = key(
        "to what the signal-to-noise ratio refers: the signal's variance, or its mean square"
    )
    sigma: list[Positive] | None = key(
        "noise of reported positions, six numbers in m and deg, in place of grid.snr; null: none",
        default=None,
        min_length=6,
        max_length=6,
        form="six numbers, those of x, y, z in m and of phi, theta, psi in deg",
    )
    exact_inertial: bool = key(
        "whether accelerations have no noise, as in the paper's tests with virtual data"
    )
    process_snr: Finite | None = key(
        "the paper's process noise v_1: what is measured wanders from the truth, by white noise of "
        "this signal-to-noise ratio on velocities and accelerations; null: none",
        unit="dB",
        default=None,
    )
    bias_drift: NotNegative = key(
        "change of the bias in 100 s, as a part of the acceleration's standard deviation"
    )
    loss_length: Positive = key("length of a loss", unit="s")
    loss_every: Positive | None = key(
        "time between losses; null: random ones, of which grid.loss is the share",
        unit="s",
        default=None,
    )
    lost_as: Literal["missing", "zeros"] = key("how a lost report arrives")
    optical_rate: Positive | None = key(
        "reports per second; null: one at every sample", unit="Hz", default=None
    )
    jitter: NotNegative = key(
        "standard deviation of the time of a report, as a part of the sampling interval; above 1 "
        "reports would overtake each other",
        le=1.0,
    )


class FloaterConfig(keys.FilteredConfig[Grid, Tuning, keys.Tuned[Tuning]]):
    """The configuration of the floater study, with all its keys."""

    axes: list[str] = keys.key_of_axes(Grid)
    motion: Motion = key("what moves, set by motion=NAME")
    sensors: Sensors = key("the optical system and the inertial unit")
    criterion: Literal["position", "velocity", "worst"] = key("what the map on the terminal judges")


#: What `studies.base` looks for.
CONFIG = FloaterConfig
