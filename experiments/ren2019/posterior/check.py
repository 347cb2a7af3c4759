"""Check stored results of the inference: some draws simulated anew, without the emulator."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from experiments.ren2019.posterior.records import print_of_tables, simulate_records
from experiments.ren2019.posterior.settings import NAMES, Reading
from owtsweep.io.tables import read_table

#: Draws that are simulated, and records of each.
DRAWS, RECORDS = 20, 16


def read_reading(evidence: pd.DataFrame) -> Reading:
    """Return the best reading, the first row of the table `evidence`."""
    row = evidence.iloc[0]
    return Reading(**{name: row[name] for name in Reading.__dataclass_fields__})


def check(folder: Path) -> int:
    """Simulate draws of the stored posterior; return 0 if they print what is stored, else 1.

    A draw's median over records must lie, for nine of ten numbers, within the stored 95 % interval
    of single records, which holds 95 % of them and more of medians.
    """
    reading = read_reading(read_table(folder, "evidence"))
    draws = read_table(folder, "draws")[NAMES].to_numpy()
    numbers = read_table(folder, "numbers")
    assert np.array_equal(numbers["published"], print_of_tables()["published"])
    chosen = draws[:: max(len(draws) // DRAWS, 1)][:DRAWS]
    inside = []
    for values in chosen:
        settings = dict(zip(NAMES, values.tolist(), strict=True))
        medians = np.median(simulate_records(reading, settings, range(RECORDS)), axis=-1)
        inside.append((medians >= numbers["low"]) & (medians <= numbers["high"]))
    share = float(np.mean(inside))
    print(f"{reading}: {share:.1%} of {64 * len(chosen)} simulated numbers lie inside")
    return 0 if share > 0.9 else 1
