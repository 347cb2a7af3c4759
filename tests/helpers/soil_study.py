"""Rows of a study with other conditions than the hub's: soil, its stiffness, sensor noise."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from owtsweep.results.conditions import Condition, Grid

SOIL = Condition("soil", "soil")
FACTOR = Condition("soil_factor", "soil stiffness factor", scale="log")
NOISE = Condition("noise", "sensor noise", "%")
GRID: Grid = {"soil": ["sand", "clay", "rock"], "soil_factor": [0.5, 1.0, 2.0], "noise": [1.0, 5.0]}
SCHEMES = ("ASKF", "DKF", "GDF")


def make_rows(conditions: Sequence[Condition], *, replicates: int = 5) -> pd.DataFrame:
    """Rows run one by one, in no order; DKF is best at the first values, GDF further on."""
    random = np.random.default_rng(4)
    rows = []
    cells = itertools.product(*(enumerate(GRID[c.name]) for c in conditions))
    for cell, scheme, replicate in itertools.product(cells, SCHEMES, range(replicates)):
        far = sum(place for place, _ in cell)
        base = {"ASKF": 3.0 + far, "DKF": 1.0 + far, "GDF": 2.0}[scheme]
        named = {c.name: value for c, (_, value) in zip(conditions, cell, strict=True)}
        for measure in ("strain", "force"):
            value = base * random.uniform(0.9, 1.1)
            case = {"scheme": scheme, "replicate": replicate, "measure": measure, "value": value}
            rows.append(named | case | {"window": "full", "status": "ok", "reason": ""})
    return pd.DataFrame(rows).sample(frac=1.0, random_state=2)


def leave(rows: pd.DataFrame, scheme: str, reason: str, **cell: float | str) -> pd.DataFrame:
    """The rows with one more that says that a scheme is unable to work in a cell."""
    line = {"scheme": scheme, "replicate": 0, "measure": "", "window": "", "value": math.nan}
    lost = pd.DataFrame([line | cell | {"status": "unable", "reason": reason}])
    return pd.concat([rows, lost], ignore_index=True)
