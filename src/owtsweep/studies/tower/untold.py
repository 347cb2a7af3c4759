"""What schemes of the tower study are not told: worlds in which sensors are worse than assumed.

Loads and structure are left out, and what an inclinometer or accelerometer feels besides: schemes
are told sizes that follow from the motion and the signals themselves.
"""

from __future__ import annotations

from owtsweep.studies.base.worlds import Departure, Untold

UNTOLD = Untold(
    ("faults.bias", "faults.drift", "faults.loss", "faults.loss_length"),
    {
        "biased": Departure(
            "each channel has an offset of a tenth of its standard deviation", {"faults.bias": 0.1}
        ),
        "drifting": Departure(
            "each channel drifts by a tenth of its standard deviation in 100 s",
            {"faults.drift": 0.1},
        ),
        "outages": Departure(
            "some 1 % of the samples repeat the last one, in outages of 100",
            {"faults.loss": 1e-4, "faults.loss_length": 100},
        ),
    },
)
