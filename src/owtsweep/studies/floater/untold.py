"""What schemes of the floater study are not told: worlds in which sensors are not as assumed.

The motion is left out: what schemes are told of it follows from the motion itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.studies.base.worlds import Departure, Untold

if TYPE_CHECKING:
    from owtsweep.studies.floater.config import FloaterConfig

KEYS = (
    "grid.delay", "grid.bias", "grid.snr", "grid.loss", "sensors.bias_drift",
    "sensors.process_snr", "sensors.loss_every", "sensors.loss_length", "sensors.jitter",
)  # fmt: skip


def list_untold(config: FloaterConfig) -> Untold:
    """Return what schemes are not told; a world that moves an axis of the map is none."""
    snr = config.grid.snr[0] - 6.0
    departures = {
        "jittering": Departure(
            "reports are late or early by half a sample", {"sensors.jitter": 0.5}
        ),
        "drifting": Departure(
            "biases drift by .3 of the accelerations' standard deviation in 100 s",
            {"sensors.bias_drift": 0.3},
        ),
        "losing": Departure("half a second is lost in every 10 s", {"sensors.loss_every": 10.0}),
        "late": Departure("reports come two samples late", {"grid.delay": 2.0}),
        "biased": Departure(
            "biases of .3 of the accelerations' standard deviation", {"grid.bias": 0.3}
        ),
        "noisy": Departure("twice the noise: 6 dB less", {"grid.snr": snr}),
    }
    mapped = {f"grid.{axis}" for axis in config.axes}
    return Untold(KEYS, {n: each for n, each in departures.items() if not mapped & {*each.keys}})
