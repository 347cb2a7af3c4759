"""The sections `wind` and `waves` of the tower study's configuration."""

from __future__ import annotations

from owtsweep.config import Finite, NotNegative, Positive, Section, key
from owtsweep.errors import require


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
        "CSV of recorded loads in place of the numbers above, with the columns time, thrust, "
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
