"""Fit Eq. (1) of Ren et al. (2019) to the plant's motion, and set it beside their Table 4.

    python -m experiments.ren2019.plant_spectrum [FOLDER] [key=value ...]

FOLDER (default: results/plant) gets plant_spectrum.csv.

The overrides are those of `sweep motion=plant`, e.g. structure=mine.yaml. For each sea state,
number of blades and friction angle, the periodograms of all records are averaged; Whittle's
likelihood then gives a, b and c, once in the whole band of waves and once around the resonance.
Rows with the source "table 4" are the published spectrum, moved to the same natural period; Ren et
al. fitted it at Hs 2 m, Tp 8 s without blades.
"""

from functools import partial
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from experiments.command import read_words, show, write
from owtsweep.motion.source import translated
from owtsweep.motion.whittle import BAND, fit_lines, periodogram
from owtsweep.streams import stream
from owtsweep.studies import compose
from owtsweep.studies.hub.records import STUDY
from owtsweep.studies.hub.worlds import PLANT

#: The band around the resonance, relative to the first natural frequency.
AROUND = 0.8, 1.25

folder, _, words = read_words("results/plant")
seas = ["motion.hs=[2.0]", "motion.tp=[6.0,8.0]", "motion.blades=[0,1,2]", "grid.replicates=20"]
config: Any = compose(["motion=plant", "record.duration=2000", *seas, *words])
step = 1.0 / config.sensors.imu.rate
steps = round(config.record.duration / step)
rows: list[dict[str, Any]] = []
grid = PLANT.get_grid(config)
for values in product(*map(sorted, grid.values())):
    conditions = dict(zip(grid, values, strict=True))
    plant = PLANT.make_source(config, conditions)
    powers = []
    for replicate in range(config.grid.replicates):
        drawn = partial(stream, config.seed, STUDY, (), replicate)
        position = plant.realise(drawn, steps=steps, step=step).position
        frequency, power = periodogram(position, step)
        powers.append(power)
    own = float(plant.vibration.frequency[0])
    near = own * AROUND[0], own * AROUND[1]
    for band in (BAND, near):
        fit = fit_lines(frequency, np.mean(powers, axis=0), band=band)
        rows.append(
            {
                "source": "plant", **conditions, "band_low": band[0], "band_high": band[1],
                "first_mode_period": 1.0 / own, "natural_period": fit.natural_period,
                "a": fit.spectrum.a, "b": fit.spectrum.b, "c": fit.spectrum.c,
                "k": fit.bandwidth, "explained": fit.explained, "band_share": fit.band_share,
            }
        )  # fmt: skip
    printed = translated(1.0 / own)
    rows.append(
        {
            "source": "table 4", **conditions, "first_mode_period": 1.0 / own,
            "natural_period": 1.0 / printed.peak_frequency,
            "a": printed.a, "b": printed.b, "c": printed.c,
            "k": printed.peak_frequency * printed.peak_margin,
        }
    )  # fmt: skip
table = pd.DataFrame(rows)
write(folder, {"plant_spectrum": table})
show(table.drop(columns=["friction_angle"]), 4)
