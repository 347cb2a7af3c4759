"""SKF: a Kalman filter that knows the spectrum of the motion and its variance.

The schemes of Ren et al. (2019) follow any motion. SKF takes the motion for what a linear system,
the shaping filter, makes of white noise, so that it has the given spectrum. Each axis has a filter
of its own, which measures IMU samples and position fixes. A fix is applied to a copy of the
position that it reports (see `estimation.late`), so there is no smoother and no predictor.

The spectrum and the variance are not data of the sensors. A sweep gives SKF those of each cell;
elsewhere the keys skf.natural_period and skf.amplitude do.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Literal

from numpy.typing import ArrayLike

from owtsweep.errors import InputError, require
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import ZERO, Known, Scheme
from owtsweep.studies.hub.known_motion import KnownMotion, find_known_motion
from owtsweep.studies.hub.models import make_fix_rule
from owtsweep.studies.hub.online.spectral import SpectralEstimator
from owtsweep.studies.hub.spectral_filter import AxisFilter, CompiledAxisFilter, KalmanAxisFilter
from owtsweep.studies.hub.spectral_model import make_axes
from owtsweep.studies.hub.worlds import require_spectrum

if TYPE_CHECKING:
    from owtsweep.studies.hub.spectral_batch import SpectralKernel


MakeFilter = type[KalmanAxisFilter] | type[CompiledAxisFilter]


class FilterPerAxis(Scheme):
    """A scheme of two filters, along x and along y, about the position of the hub at rest."""

    on_board = True

    def start(self, known: Known) -> SpectralEstimator:
        return SpectralEstimator(self.make_filters(known, KalmanAxisFilter), known.sensors)

    def stream(self, known: Known, origin: ArrayLike | None = ZERO) -> SpectralEstimator:
        """Return a new compiled estimator; `origin` is the hub at rest, m, and must be stated."""
        filters = self.make_filters(known, CompiledAxisFilter)
        return SpectralEstimator(filters, known.sensors, origin)

    @abstractmethod
    def make_filters(self, known: Known, filter: MakeFilter) -> tuple[AxisFilter, AxisFilter]:
        """Return the filters along x and y before their first step; `filter` is their class."""


class SpectralScheme(FilterPerAxis):
    """The scheme SKF. Its methods raise InputError if nothing says what the motion is."""

    name = "SKF"
    #: Estimates are linear in the measurements, but the gains are those of one amplitude.
    linear = True
    sections = ("skf", "spectrum", "normalise", "band", "wave_direction")
    knows_motion = True
    expected_in_cell = True
    batched: Literal["", "chain", "own"] = "own"

    def make_filters(self, known: Known, filter: MakeFilter) -> tuple[AxisFilter, AxisFilter]:
        skf = known.tuning.skf
        x, y = make_axes(find_motion(known), skf, known.sensors)
        rule = make_fix_rule(skf, skf.fix_rule or "plain", axes=1)
        return filter(x, rule), filter(y, rule)

    def own_kernel(self, known: Known, steps: int) -> SpectralKernel:
        from owtsweep.studies.hub.spectral_batch import SpectralKernel

        return SpectralKernel(make_axes(find_motion(known), known.tuning.skf, known.sensors))

    def under(self, config: HubConfig) -> Scheme:
        return self if config.skf.fix_rule in (None, "plain") else WeighingSpectralScheme()

    def check(self, config: HubConfig) -> None:
        require_spectrum(config, "SKF")
        states = config.skf.states
        require(
            states % 2 == 0,
            f"skf.states: {states} is odd, and the states of a shaping filter come in pairs; use "
            f"{states - 1} or {states + 1}",
        )


class WeighingSpectralScheme(SpectralScheme):
    """SKF with a gate or Huber's rule: its gains depend on the measurements."""

    linear = False
    expected_in_cell = False
    batched = ""


def find_motion(known: Known) -> KnownMotion:
    """Return what SKF takes for the motion: what its keys say, else what is known.

    Raises InputError if nothing says what the motion is.
    """
    own = known.tuning.skf
    period = known.natural_period if own.natural_period is None else own.natural_period
    amplitude = known.amplitude if own.amplitude is None else own.amplitude
    if period is None or amplitude is None:
        raise InputError(
            "skf.natural_period, skf.amplitude: SKF must be told the motion; give the period of "
            "its peak and its amplitude, e.g. skf.natural_period=4 skf.amplitude=0.5"
        )
    return find_known_motion(known.tuning, period, amplitude)


SCHEME = SpectralScheme()
