"""Computes the curves of the study's schemes, or reads them from the cache, and sums over them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.spectra import spectrum
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.cache import cached
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.error_curves.curves import Curves, curves
from owtsweep.studies.hub.error_curves.shares import expected_ratio, lines_of
from owtsweep.studies.hub.known import Known
from owtsweep.studies.hub.names import list_entries
from owtsweep.studies.hub.peak import peak_factors
from owtsweep.studies.hub.planning import scheme_content
from owtsweep.studies.hub.resolving import SCHEMES, resolve

#: Version of the expected errors. Raise it when they change and the study's `numerics_version`
#: stays the same.
EXPECTED_VERSION = 2


def curves_of(config: HubConfig, name: str) -> Curves:
    """Compute the curves (expected errors) of a scheme of the study, or read them from the cache.

    `name` is the scheme's name. The cache is not used for a scheme of the user if changes of its
    code could not be noticed.
    """
    sensors = sensing.sensors(config.sensors)
    steps = round(config.record.duration / sensors.step)
    settled = round(config.measures.settling_time / sensors.step)
    band = (config.band[0], config.band[1])
    entry = {resolve(entry).name: entry for entry in list_entries(config)}[name]
    scheme = resolve(entry)
    what = {
        "what": "curves",
        "version": EXPECTED_VERSION,
        "sensors": asdict(sensors),
        "scheme": scheme_content(config, entry, scheme),
        "steps": steps,
        "settled": settled,
        "band": list(band),
    }

    def compute() -> dict[str, Array]:
        chain = scheme.kernel(Known(sensors, config), steps)
        return vars(curves(chain, sensors, steps=steps, settled=settled, band=band))

    if SCHEMES.explain_anew(scheme):
        return Curves(**compute())
    return Curves(**cached(what, compute))


def motion_of(config: HubConfig, curve: Curves, periods: Sequence[float]) -> Array:
    """Compute the expected mean square error due to motion of amplitude 1 m at natural periods (s).

    `curve` holds the scheme's errors at each frequency. The axes of the result are natural period,
    measure (position, velocity), window (full, settled).
    """
    lines = lines_of((config.band[0], config.band[1]), config.record.duration)
    at_lines = curve.at(lines.frequency)
    kind, bandwidth = config.spectrum.kind, config.spectrum.bandwidth
    expected = np.array(
        [expected_ratio(spectrum(kind, period, bandwidth), at_lines, lines) for period in periods]
    )
    if config.normalise == "peak":
        expected *= peak_factors(config, periods)[:, None, None]
    return expected
