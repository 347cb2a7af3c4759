"""The sections of the tower study's configuration that are its own."""

from __future__ import annotations

from typing import Literal

from owtsweep.config import Axis, Finite, NotNegative, Positive, Section, key
from owtsweep.config.grid import Records
from owtsweep.errors import require

#: Name of a list of sensors in the section `sensors` -> kind of its channels.
KINDS: dict[str, Literal["x", "theta", "a", "strain"]] = {
    "displacement": "x",
    "inclinometers": "theta",
    "accelerometers": "a",
    "strain": "strain",
}


class Grid(Records):
    """The section `grid`: what is swept over."""

    noise: Axis[NotNegative] = key(
        "standard deviation of a sensor's white noise, as a part of its signal's own", unit="%"
    )
    soil_factor: Axis[Positive] = key(
        "stiffness of the soil in the schemes' model over the true one; 1: right"
    )


class Truth(Section):
    """The section `truth`: the structure as it is."""

    gravity: bool = key("whether the weight softens the structure (p-delta)")
    subdivision: int = key(
        "elements of the truth in each element of the schemes' mesh", ge=1, le=10
    )


class TopLoad(Section):
    """One load on the top of the structure: its mean and its standard deviation."""

    mean: Finite = key("mean, in N or N m")
    sigma: NotNegative = key("standard deviation, in N or N m")


class Wind(Section):
    """The section `wind`: loads of the rotor on the top of the structure.

    They stand for a controlled rotor in turbulence; there is no rotor in the truth. Sizes are those
    that a rough estimate for the IEA 15 MW turbine at 8 m/s gives (docs/tower.md).
    """

    speed: Positive = key("mean wind speed at the hub", unit="m/s")
    rotor_area: Positive = key("swept area, which averages the gusts", unit="m^2")
    rotor_speed: Positive = key("revolutions of the rotor", unit="Hz")
    thrust: TopLoad = key("force fore-aft, N")
    moment: TopLoad = key("moment fore-aft, N m; negative: it leans the tower upwind")
    side: TopLoad = key("force side-side, N")
    side_moment: TopLoad = key("moment side-side, N m")
    line_1p: float = key("share of the variance once per revolution", ge=0.0, le=1.0)
    line_3p: float = key("share of the variance three times per revolution", ge=0.0, le=1.0)
    damping: NotNegative = key("aerodynamic damping fore-aft, at the top", unit="N s/m")
    side_damping: NotNegative = key("aerodynamic damping side-side, at the top", unit="N s/m")
    file: str | None = key(
        "table of recorded loads in place of the numbers above, with the columns time, thrust, "
        "moment, side, side_moment; null: none",
        default=None,
    )

    def check(self) -> None:
        """Raise `InputError` if the lines have more than all of the variance."""
        require(
            self.line_1p + self.line_3p <= 1.0,
            f"wind.line_1p: with line_3p the lines have {self.line_1p + self.line_3p:g} of the "
            "variance; they may have 1 at most",
        )


class SeaState(Section):
    """The section `waves`: a JONSWAP sea, or none."""

    hs: NotNegative = key("significant wave height; 0: no waves", unit="m")
    tp: Positive = key("period of the spectrum's peak", unit="s")
    gamma: float = key("peak enhancement factor", default=3.3, ge=1.0)
    yaw: Finite = key("direction of the waves against the wind", unit="deg", default=0.0)


class Sensors(Section):
    """The section `sensors`: where sensors are; each measures fore-aft and side-side.

    Heights are in m above the ground, at nodes of the mesh.
    """

    name: str = key("name of the set-up, for titles")
    every_node: list[Literal["displacement", "inclinometers", "accelerometers", "strain"]] = key(
        "which sensors are at every node, besides those listed below"
    )
    displacement: list[Finite] = key("displacement sensors", unit="m")
    inclinometers: list[Finite] = key("inclinometers", unit="m")
    accelerometers: list[Finite] = key("accelerometers", unit="m")
    strain: list[Finite] = key("strain gauges on the outer fibre", unit="m")
    gnss: list[Finite] = key("GNSS receivers: displacement with a noise of its own", unit="m")
    gnss_sigma: Positive = key(
        "standard deviation of a GNSS sample; of fixes at another rate, times the square root of "
        "rate.record / rate.fixes",
        unit="m",
    )


class Faults(Section):
    """The section `faults`: what is wrong with sensors besides white noise; no scheme knows it.

    Sizes are parts of each channel's own standard deviation.
    """

    bias: NotNegative = key("constant offset, with a random sign", default=0.0)
    drift: NotNegative = key("Wiener process: its standard deviation after 100 s", default=0.0)
    loss: float = key(
        "probability that an outage begins at a sample; lost samples repeat the last one",
        default=0.0,
        ge=0.0,
        lt=1.0,
    )
    loss_length: int = key("of an outage, in samples", default=100, ge=1)
    tilted_accelerometers: bool = key("whether accelerometers read a - g theta", default=False)
    accelerated_inclinometers: bool = key("whether inclinometers read theta - a/g", default=False)


class Model(Section):
    """The section `model`: the schemes' model of the structure, and what is wrong in it."""

    modes: int = key("free-interface normal modes of the substructure", ge=1, le=100)
    whole_modes: int = key("modes of the whole structure", ge=1, le=100)
    gravity: bool = key("whether the weight softens the model")
    stiffness: Positive = key("factor on E I of the tubes; 1: right")
    mass: Positive = key("factor on the mass of the tubes; 1: right")
    water_level: Finite = key("height of the model's sea level above the true one", unit="m")
    damping: Positive = key("factor on all damping; 1: right")
    rotor_mass: Positive = key("factor on mass and inertia of rotor and nacelle; 1: right")


class Recorded(Section):
    """The section `recorded`: a record of a structure in place of a simulated truth."""

    file: str | None = key(
        "table with a column of time and columns such as a_012 (docs/recorded.md); null: the truth "
        "is simulated",
        default=None,
    )
    columns: list[str] = key(
        "SIGNAL:NAME or SIGNAL:NAME:UNIT where a signal's column has another name or unit, e.g. "
        "[a_012:ACC3:g]",
        default_factory=list,
    )
