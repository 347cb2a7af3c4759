"""SKFA: SKF that is given nothing, and tracks the spectrum and the variance of the motion itself.

It is for steady seas. It refuses outlying fixes, and tracks their noise and the tilt of the IMU
(docs/better.md, "Bad fixes"). See `motion.tracking` for how a spectrum is chosen, and
`tracking_filter` for what follows from it.
"""

from __future__ import annotations

import logging
from functools import partial

from owtsweep.motion.tracking import LEAST
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known
from owtsweep.studies.hub.models import make_fix_rule
from owtsweep.studies.hub.schemes.skf import FilterPerAxis, MakeFilter
from owtsweep.studies.hub.spectral_filter import AxisFilter
from owtsweep.studies.hub.tracking_filter import TrackingFilter

logger = logging.getLogger(__name__)


class AdaptiveSpectralScheme(FilterPerAxis):
    """The scheme SKFA. Its gains depend on the measurements, so it is not linear."""

    name = "SKFA"
    sections = ("skf", "band")
    least_duration = LEAST

    def make_filters(self, known: Known, filter: MakeFilter) -> tuple[AxisFilter, AxisFilter]:
        low, high = known.tuning.band
        skf = known.tuning.skf
        rule = make_fix_rule(skf, skf.fix_rule or "gate", axes=1)
        make = partial(TrackingFilter, skf, known.sensors, (low, high), rule, filter)
        return make(), make()

    def check(self, config: HubConfig) -> None:
        """Warn of records that are too short to choose a spectrum."""
        if config.record.duration < LEAST:
            logger.warning(
                "schemes: SKFA chooses a spectrum after %g s; records of %g s leave it no time, so "
                "it assumes next to nothing of the motion",
                LEAST,
                config.record.duration,
            )


SCHEME = AdaptiveSpectralScheme()
