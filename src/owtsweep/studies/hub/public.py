"""What other studies use of the hub study; they import nothing else of it.

A name is looked up when it is asked for: whoever takes `Sensors` loads no kernel.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from owtsweep.studies.hub.batch import Lanes, chunks, state_chunks
    from owtsweep.studies.hub.blocks import backend, scheme_content
    from owtsweep.studies.hub.chain import Chain, chain_for_runs
    from owtsweep.studies.hub.config import Grid, HubConfig
    from owtsweep.studies.hub.contract import Scheme, Sensors
    from owtsweep.studies.hub.error_spectrum import ErrorSpectrum, error_spectrum, expected_mse
    from owtsweep.studies.hub.fidelity.score import (
        at_amplitude,
        compare,
        make_lanes,
        scheme_products,
        score,
    )
    from owtsweep.studies.hub.filter_states import bias_of, has_acceleration, lag_of
    from owtsweep.studies.hub.kernels.layout import WIDTH
    from owtsweep.studies.hub.noise_floor import NoiseFloor, noise_floor
    from owtsweep.studies.hub.rows import Rows
    from owtsweep.studies.hub.schemes import resolve_all
    from owtsweep.studies.hub.sensors import ForceNoise, fix_count, fix_noise
    from owtsweep.studies.hub.sensors import sensors as make_sensors
    from owtsweep.studies.hub.true_bias import simulate_bias

__all__ = [
    "WIDTH", "Chain", "ErrorSpectrum", "ForceNoise", "Grid", "HubConfig", "Lanes",
    "NoiseFloor", "Rows", "Scheme", "Sensors", "at_amplitude", "backend", "bias_of",
    "chain_for_runs", "chunks",
    "compare", "error_spectrum", "expected_mse", "fix_count", "fix_noise", "has_acceleration",
    "lag_of", "make_lanes", "make_sensors", "noise_floor", "resolve_all",
    "scheme_content", "scheme_products", "score", "simulate_bias", "state_chunks",
]  # fmt: skip

#: Name -> its module.
_HOMES = {
    # configuration
    "HubConfig": "config",  # all keys of the hub study, to extend
    "Grid": "config",  # its axes
    # sensors
    "Sensors": "contract",  # what an estimator may know of its sensors
    "make_sensors": "sensors",  # `Sensors` of a configuration
    "ForceNoise": "sensors",  # all of the specific force but motion, piece by piece
    "fix_count": "sensors",  # how many fixes a record has
    "fix_noise": "sensors",  # the noise of its fixes
    "simulate_bias": "true_bias",  # the bias that its noise holds
    # schemes and how they run
    "Scheme": "contract",  # an estimation scheme
    "resolve_all": "schemes",  # the schemes that a configuration names
    "scheme_content": "blocks",  # what a block's key holds of a scheme
    "backend": "blocks",  # threads or processes
    "Chain": "chain",  # a scheme as the kernels run it
    "chain_for_runs": "chain",  # make one
    "WIDTH": "kernels.layout",  # series that a kernel runs side by side
    "Rows": "rows",  # a series that is made as the kernels need it
    "chunks": "batch",  # the estimates of a chain, chunk by chunk
    "state_chunks": "batch",  # the states of its filter, chunk by chunk
    "lag_of": "filter_states",  # how late they are
    "has_acceleration": "filter_states",  # whether acceleration is one of them
    "bias_of": "filter_states",  # the bias that they mean
    # errors without records
    "ErrorSpectrum": "error_spectrum",  # error per unit of motion over frequency
    "error_spectrum": "error_spectrum",  # compute it
    "expected_mse": "error_spectrum",  # the MSE that it means for a spectrum of the motion
    "NoiseFloor": "noise_floor",  # MSE that the sensors' noise makes
    "noise_floor": "noise_floor",  # compute it
    # the distance from the published numbers
    "Lanes": "batch",  # the records of one natural period, as the kernels take them
    "make_lanes": "fidelity.score",  # those of all natural periods
    "scheme_products": "fidelity.score",  # mean products of a scheme on them
    "at_amplitude": "fidelity.score",  # the MSE that products mean at an amplitude
    "compare": "fidelity.score",  # products against the published numbers
    "score": "fidelity.score",  # one number of all four schemes
}
#: Names that are others there.
_OTHER_NAMES = {"make_sensors": "sensors"}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = import_module(f"owtsweep.studies.hub.{_HOMES[name]}")
    return getattr(home, _OTHER_NAMES.get(name, name))
