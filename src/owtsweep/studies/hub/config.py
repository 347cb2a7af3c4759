"""The configuration of the hub-motion study: its keys, types, bounds and meanings.

Units are SI, but angles (wave direction, yaw) are in degrees. The sections that tune schemes are in
`scheme_sections`.
"""

from __future__ import annotations

import math
import re
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from owtsweep.config import Axis, Config, Finite, NotNegative, Positive, Section, key, require
from owtsweep.config.grid import Records
from owtsweep.config.section import require_magnitude
from owtsweep.config.tuned import ABSENT, TunedConfig
from owtsweep.motion.source import Spectrum, printed, translated
from owtsweep.structures import Structure
from owtsweep.structures.description import ANGLES
from owtsweep.studies.base.schemes import SchemeEntries
from owtsweep.studies.hub.scheme_sections import FilterTuning, Hme, Skf, Switch, Tuning


class Outliers(Section):
    """Fixes with a gross error, which is added to the white noise of every fix."""

    rate: float = key("share of the fixes that are outliers; 0: none", default=0.0, ge=0.0, le=0.5)
    size: Positive = key(
        "standard deviation of an outlier's offset along each axis",
        unit="standard deviations of a fix",
        default=10.0,
    )
    length: int = key(
        "length of a burst, whose fixes share one offset (multipath); 1: each outlier by itself",
        unit="fixes",
        default=1,
        ge=1,
    )


class Loss(Section):
    """Fixes that never arrive, one by one or in outages."""

    probability: float = key(
        "probability that an outage begins at a fix; 0: no fix is lost", default=0.0, ge=0.0, lt=1.0
    )
    length: int = key("length of an outage", unit="fixes", default=1, ge=1)


class Correlation(Section):
    """Noise of low frequency on top of the white noise: a first-order Gauss-Markov process."""

    sigma: NotNegative = key(
        "standard deviation of the red noise, per axis; 0: none", unit="m", default=0.0
    )
    time: Positive = key("time constant of the red noise", unit="s", default=60.0)


class Gnss(Section):
    """The properties of the position sensor, GNSS."""

    sigma: Positive = key("standard deviation of a fix, per axis", unit="m")
    rate: Positive = key("fixes per second; divides the IMU's rate", unit="Hz")
    delay: NotNegative = key("age of a fix when it arrives; whole IMU steps", unit="s")
    scale: Positive = key(
        "scale error: a fix is the position times this number, plus noise; 1: none", default=1.0
    )
    outliers: Outliers = key("fixes with a gross error", default=Outliers())
    loss: Loss = key("fixes that never arrive", default=Loss())
    correlation: Correlation = key(
        "red noise of the fixes, besides their white noise", default=Correlation()
    )

    @property
    def loses(self) -> bool:
        return self.loss.probability > 0.0


#: Value of `sensors.imu.tilt`: the IMU leans as the structure does, mode by mode.
STRUCTURE = "structure"


def _read_tilt(value: Any) -> float | str:
    """Return a tilt in rad/m, or the word `structure`."""
    if value == STRUCTURE:
        return STRUCTURE
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{value!r} is neither a number nor the word {STRUCTURE}") from None
    if not math.isfinite(number):
        raise ValueError(f"{number:g} rad/m must be a finite number")
    return require_magnitude(number)


#: A tilt in rad/m, or the word `structure`.
Tilt = Annotated[float | str, BeforeValidator(_read_tilt)]


class Grid(Records):
    """The axes of the sweep: the values of each condition, and the number of replicates."""

    natural_period: Axis[Positive] = key("natural periods of the turbine", unit="s")
    amplitude: Axis[Positive] = key("largest displacement of a record (normalise: peak)", unit="m")


class MotionConfig(Section):
    """Where the motion comes from: a spectrum, or a structure under waves (the plant).

    All keys but `kind`, `envelope`, `peaks` and `pace` belong to the plant, and to a spectrum's
    motion in its place (the key `structure`).
    """

    kind: Literal["spectrum", "plant"] = key(
        "spectrum: the spectrum of the key `spectrum`; plant: the structure of the key `structure` "
        "under waves (choose by motion=plant)",
        default="spectrum",
    )
    hs: Axis[Positive] | None = key(
        "significant wave heights of the sea states", unit="m", default=None
    )
    tp: Axis[Positive] | None = key("peak periods of the sea states", unit="s", default=None)
    blades: Axis[Annotated[int, Field(ge=0, le=3)]] | None = key("mounted blades", default=None)
    friction_angle: Axis[Annotated[float, Field(ge=ANGLES[0], le=ANGLES[1])]] | None = key(
        "angles of internal friction, each set in every layer of the soil; null: the structure's "
        "own layers",
        unit="deg",
        default=None,
    )
    gamma: float = key("peak enhancement factor of the JONSWAP spectrum", default=3.3, ge=1, le=10)
    modes: int = key("modes of the structure that answer", default=4, ge=1)
    damping: float | None = key(
        "damping ratio of every mode; null: the structure's own", default=None, gt=0.0, lt=1.0
    )
    envelope: list[list[Finite]] | None = key(
        "pairs of time (s) and factor on the amplitude, e.g. [[0,0.1],[1000,10]]: a sea that grows "
        "and falls (motion=spectrum only); null: none",
        default=None,
    )
    peaks: list[Positive] | None = key(
        "peaks of the spectrum that share its variance equally, in place of the natural period's, "
        "e.g. [0.1,0.26] (motion=spectrum only); null: none",
        unit="Hz",
        default=None,
        min_length=1,
    )
    pace: list[list[Finite]] | None = key(
        "pairs of time (s) and factor on the motion's frequency, e.g. [[150,1],[450,1.1]]: a "
        "period that drifts (motion=spectrum only); null: none",
        default=None,
    )


class Record(Section):
    """The length of a record of motion and measurements."""

    duration: Positive = key("length of a record", unit="s")


class SpectrumConfig(Section):
    """The spectrum of the motion."""

    kind: Literal["translated", "printed"] = key(
        "translated: one peak moved along the frequency axis; printed: Table 4 as it stands"
    )
    bandwidth: Positive = key(
        "k, the squared half-bandwidth of the peak (translated only)", unit="s^-2"
    )

    def at(self, natural_period: float) -> Spectrum:
        """Return the spectrum of a natural period (s).

        Raise `InputError` if the printed spectrum does not exist for the natural period.
        """
        if self.kind == "printed":
            return printed(natural_period)
        return translated(natural_period, self.bandwidth)


class Imu(Section):
    """The properties of the accelerometers, the IMU."""

    sigma: Positive = key("standard deviation of a sample, per axis", unit="m/s^2")
    rate: Positive = key("samples per second", unit="Hz")
    bias_initial: Finite = key("bias at the start of a record, per axis", unit="m/s^2")
    bias_walk: NotNegative = key("intensity of the bias' random walk", unit="m/s^2/sqrt(s)")
    tilt: Tilt = key(
        "lean of the IMU per displacement; above zero: it leans the way that it moves, so the "
        "specific force is a - g tilt d; `structure`: as the structure leans, mode by mode "
        "(motion=plant only)",
        unit="rad/m",
        default=0.0,
    )
    high_pass: Positive | None = key(
        "corner of an AC coupling, a first-order high-pass of what the IMU feels of the motion "
        "(its noise and bias do not pass it); null: none",
        unit="Hz",
        default=None,
    )


class SensorConfig(Section):
    """The sensors, GNSS and IMU, and the orientation of the IMU."""

    gnss: Gnss = key("the position sensor")
    imu: Imu = key("the accelerometers")
    accuracy: Literal["sigma", "uniform", "bound"] = key(
        "what gnss.sigma and imu.sigma are: standard deviations (sigma) or, as the plus-minus "
        "signs of Table 5 may mean, bounds: those of a uniform distribution (uniform), or three "
        "standard deviations (bound)"
    )
    yaw: Finite = key("fixed yaw of the IMU", unit="deg")
    gravity: list[Finite] = key(
        "horizontal part of gravity, north and east",
        unit="m/s^2",
        form="two numbers, north and east, in m/s^2",
        min_length=2,
        max_length=2,
    )

    @property
    def deviations(self) -> float:
        """Standard deviations that gnss.sigma and imu.sigma are."""
        return {"sigma": 1.0, "uniform": math.sqrt(3.0), "bound": 3.0}[self.accuracy]


class Measures(Section):
    """The measures to compute, and the criterion by which schemes are ranked."""

    settling_time: NotNegative = key("left out of the window settled", unit="s")
    window: Literal["full", "settled"] = key("the window that the map judges")
    criterion: Literal["position", "velocity", "x", "y"] = key(
        "the MSE that the map judges: position is x + y, velocity is vx + vy"
    )
    extremes: bool = key(
        "also the largest and the 95th percentile position error; needs evaluation=direct"
    )
    efficiency: bool = key(
        "also how near the schemes come to the bounds of the settled position and velocity MSE: "
        "columns efficiency_a and efficiency_b of summary.csv, and a figure",
        default=False,
    )

    def find_settled(self, step: float) -> int:
        """Return the number of the first step after the settling time; `step` in s."""
        return round(self.settling_time / step)


class Tune(Section):
    """The settings of the command `tune`. No result of a run depends on them."""

    amplitude: list[Positive] | None = key(
        "smallest and largest amplitude that `tune` tunes for; null: those of the grid",
        unit="m",
        form="two amplitudes in m, smallest first, e.g. tune.amplitude=[0.2,3]",
        default=None,
        min_length=2,
        max_length=2,
    )
    trials: int = key("trials of `tune` per scheme", default=100, ge=1, le=100_000)
    seed: int = key(
        "of the search; not the run's `seed`, with which `tune` judges what it found",
        default=7,
        ge=0,
        advice="use an integer >= 0",
    )
    replicates: int = key(
        "records per natural period on which `tune` judges what it found", default=8, ge=2, le=1000
    )


#: In a run of several tunings, these sections stand in `tunings.<name>`, not at the top.
TUNED = tuple(Tuning.model_fields)


class HubConfig(TunedConfig):
    """The configuration of the hub-motion study, with all its keys.

    With several tunings, `tuning` is the list of their names, `tunings` holds their sections, and
    the sections `ekf` to `hme` are absent. `by_tuning` gives the configuration of each.
    """

    inert: ClassVar[frozenset[str]] = Config.inert | {
        "tuning", "baselines", "measures.window", "measures.criterion",
        "measures.efficiency",
    }  # fmt: skip
    tuned: ClassVar[tuple[str, ...]] = TUNED
    swept: ClassVar[tuple[str, ...]] = (
        "motion.hs", "motion.tp", "motion.blades", "motion.friction_angle",
    )  # fmt: skip
    from_files: ClassVar[tuple[str, ...]] = ("structure",)

    engine: Literal["batch", "reference", "expected"] = key(
        "batch: compiled; reference: the algorithms as written, slow; expected: the mean over all "
        "records, without one",
        default="batch",
    )
    evaluation: Literal["superposed", "direct"] = key(
        "superposed: linear schemes run once for all amplitudes; direct: each amplitude is run"
    )
    grid: Grid = key("the axes of the sweep")
    record: Record = key("a record of motion and measurements")
    motion: MotionConfig = key("where the motion comes from", default=MotionConfig())
    structure: Structure | None = key(
        "the structure that moves; with motion=spectrum it moves in one sea (motion.hs, tp, "
        "blades), with its time stretched until its first mode has the cell's natural period, and "
        "with the cell's amplitude",
        default=None,
    )
    spectrum: SpectrumConfig = key("the spectrum of the motion")
    normalise: Literal["peak", "rms"] = key(
        "what is 1 m before the amplitude is applied: the largest displacement or its standard "
        "deviation"
    )
    band: list[Positive] = key(
        "edges of the synthesised motion",
        unit="Hz",
        form="two edges in Hz, e.g. band=[0.05,0.6]",
        min_length=2,
        max_length=2,
    )
    wave_direction: Finite = key("of the motion, from north towards east", unit="deg")
    sensors: SensorConfig = key("GNSS and IMU")
    tuning: str | list[str] = key(
        "name of the file that sets the keys of the schemes, or a list of names, whose tunings run "
        "on the same records"
    )
    tunings: dict[str, Tuning] = key(
        "name: the sections ekf, mkf, hme1, hme2, hme of this tuning; only with several tunings",
        default={},
    )
    schemes: SchemeEntries = key(
        "names, or {_target_: package.Class, ...} for a scheme of your own"
    )
    baselines: list[Literal["NONE", "HOLD", "DELTA"]] = key(
        "shown beside the schemes: no estimator, the last fix, the last two fixes extrapolated; "
        "[]: none",
        default=[],
    )
    ekf: FilterTuning = key("the filter of EKF", default=ABSENT)
    mkf: FilterTuning = key("the filter of MKF", default=ABSENT)
    hme1: FilterTuning = key("the filter of HME1", default=ABSENT)
    hme2: FilterTuning = key("the filter of HME2", default=ABSENT)
    hme: Hme = key("smoother of HME1 and HME2, MHE of HME2", default=ABSENT)
    skf: Skf = key(
        "SKF and SKFA, which know the spectrum of the motion, or track it; on request, "
        "schemes=[...,SKF,SKFA]",
        default=Skf(),
    )
    switch: Switch = key("the scheme SWITCH", default=Switch())
    measures: Measures = key("what is measured, and what the map judges")
    tune: Tune = key("what the command `tune` searches", default=Tune())

    def check(self) -> None:
        """Check as `TunedConfig.check`, and that tunings' names can be part of a file's name."""
        super().check()
        for name in self.tunings:
            require(
                re.fullmatch(r"[\w.+=-]+", name) is not None,
                f"tuning: {name!r} cannot be part of a file's name; use letters, digits, . _ - + =",
            )
