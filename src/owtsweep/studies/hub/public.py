"""The names of the hub study that other studies may use.

Names of modules that load kernels or tables are imported at first use; so importing `Sensors`, for
example, is quick.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from owtsweep.studies.hub.config import Grid, HubConfig
from owtsweep.studies.hub.contract import (
    BASELINES,
    INSTEAD,
    SCHEMES,
    Known,
    Scheme,
    resolve,
    resolve_all,
)
from owtsweep.studies.hub.kernels.layout import WIDTH
from owtsweep.studies.hub.measures import JUDGED
from owtsweep.studies.hub.sensors import ForceNoise, Sensors, fix_count, fix_noise, simulate_bias
from owtsweep.studies.hub.sensors import sensors as make_sensors
from owtsweep.studies.hub.study import ROOMS, HubKeys
from owtsweep.studies.hub.tuning_rules import assume_tilt, follow_sensors
from owtsweep.studies.hub.worlds import find_world

if TYPE_CHECKING:
    from owtsweep.studies.hub.batch import backend
    from owtsweep.studies.hub.chain import Chain, bias_of, has_acceleration, lag_of
    from owtsweep.studies.hub.describe import tell_window
    from owtsweep.studies.hub.error_spectrum import (
        ErrorSpectrum,
        error_spectrum,
        expected_mse,
        look_constant,
    )
    from owtsweep.studies.hub.estimates import OnePassSeries, chunks, state_chunks, trajectories
    from owtsweep.studies.hub.expected.answers import make_field
    from owtsweep.studies.hub.noise_floor import NoiseFloor, noise_floor

__all__ = [
    "BASELINES", "INSTEAD", "JUDGED", "ROOMS", "SCHEMES", "WIDTH", "Chain", "ErrorSpectrum",
    "ForceNoise", "Grid", "HubConfig", "HubKeys", "Known", "NoiseFloor", "OnePassSeries", "Scheme",
    "Sensors", "assume_tilt", "backend", "bias_of", "chunks", "error_spectrum", "expected_mse",
    "find_world", "fix_count", "fix_noise", "follow_sensors", "has_acceleration", "lag_of",
    "look_constant", "make_field", "make_sensors", "noise_floor", "resolve", "resolve_all",
    "simulate_bias", "state_chunks", "tell_window", "trajectories",
]  # fmt: skip

#: Module -> names that it provides at first use.
_HOMES = {
    "batch": ["backend"],
    "chain": ["Chain", "bias_of", "has_acceleration", "lag_of"],
    "describe": ["tell_window"],
    "error_spectrum": ["ErrorSpectrum", "error_spectrum", "expected_mse", "look_constant"],
    "estimates": ["OnePassSeries", "chunks", "state_chunks", "trajectories"],
    "expected.answers": ["make_field"],
    "noise_floor": ["NoiseFloor", "noise_floor"],
}


def __getattr__(name: str) -> Any:
    for home, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f"owtsweep.studies.hub.{home}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
