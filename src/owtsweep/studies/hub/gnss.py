"""The section of the configuration on the position sensor, GNSS, and on what may go wrong with it.

Outliers, lost fixes and red noise belong to the truth; no estimator of the package is told of them.
"""

from __future__ import annotations

from owtsweep.config import NotNegative, Positive, Section, key


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
        """Whether fixes may be lost."""
        return self.loss.probability > 0.0

    def list_faults(self) -> dict[str, str]:
        """Return name -> value, in words, of outliers, outages and red noise, if there are any."""
        told = {}
        if self.outliers.rate > 0.0:
            burst = f" in bursts of {self.outliers.length}" if self.outliers.length > 1 else ""
            told["GNSS outliers"] = (
                f"{self.outliers.rate:.3g} of {self.outliers.size:g} sigma{burst}"
            )
        if self.loses:
            told["GNSS outages"] = f"of {self.loss.length} with {self.loss.probability:.3g} per fix"
        if self.correlation.sigma > 0.0:
            red = self.correlation
            told["GNSS red noise"] = f"{red.sigma:g} m of {red.time:g} s"
        return told
