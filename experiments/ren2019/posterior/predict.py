"""Predict the 64 numbers of one record: from all of them, and each table from the other three."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from experiments.ren2019.evidence import SCHEMES, TABLE_CELLS
from experiments.ren2019.posterior.evidence import Posterior
from experiments.ren2019.posterior.likelihood import Likelihood
from experiments.ren2019.posterior.records import print_of_tables
from owtsweep.arrays import Array

#: Draws of a posterior from which a prediction is made.
DRAWS = 1000
Sampler = Callable[[list[Likelihood]], list[Posterior]]


def draw_records(likelihood: Likelihood, posterior: Posterior, seed: int = 11) -> Array:
    """Return logarithms of the 64 numbers of one record per draw, shape (draws, 64)."""
    generator = np.random.default_rng(seed)
    freedom, found = likelihood.scatter.freedom, []
    for point in posterior.points[:DRAWS]:
        mean, variances = likelihood.predict(point)
        factor = np.linalg.cholesky(likelihood.covariance(point, variances))
        tail = np.sqrt((freedom - 2.0) / generator.chisquare(freedom))
        found.append(mean + tail * (factor @ generator.standard_normal(len(mean))))
    return np.array(found)


def leave_tables_out(likelihood: Likelihood, sample_all: Sampler) -> dict[int, Array]:
    """Return table -> logarithms of its 16 numbers as the other three predict, (draws, 16)."""
    lines = print_of_tables()["table"].to_numpy()
    without = [replace(likelihood, used=lines != table) for table in TABLE_CELLS]
    return {
        table: draw_records(each, posterior)[:, lines == table]
        for table, each, posterior in zip(TABLE_CELLS, without, sample_all(without), strict=True)
    }


def predict_numbers(
    likelihood: Likelihood, posterior: Posterior, left_out: Mapping[int, Array]
) -> pd.DataFrame:
    """Return the 64 numbers with the medians and 95 % intervals of both predictions.

    Columns of `print_of_tables`, then low, median, high (from all numbers) and out_low, out_median,
    out_high (from the other three tables), inside (whether the print lies within the latter).
    """
    table = print_of_tables()[["table", "scheme", "measure", "published"]].copy()
    both = (draw_records(likelihood, posterior), np.hstack(list(left_out.values())))
    for name, logs in zip(("", "out_"), both, strict=True):
        ends = np.exp(np.quantile(logs, [0.025, 0.5, 0.975], axis=0))
        for part, row in zip(("low", "median", "high"), ends, strict=True):
            table[name + part] = row
    table["inside"] = table["published"].between(table["out_low"], table["out_high"])
    return table


def tabulate_left_out(
    likelihoods: Sequence[Likelihood], predicted: Sequence[pd.DataFrame]
) -> pd.DataFrame:
    """Return per reading how its predictions of tables left out meet the print.

    Columns of the reading; inside, of 64; width, the median factor either way; outside, which.
    """
    rows = []
    for likelihood, numbers in zip(likelihoods, predicted, strict=True):
        outside = numbers[~numbers["inside"]]
        named = [f"{row.table} {row.scheme} {row.measure}" for row in outside.itertuples()]
        widths = np.log(numbers["out_high"] / numbers["out_low"])
        rows.append(
            {
                **vars(likelihood.reading),
                "inside": int(numbers["inside"].sum()),
                "width": float(np.exp(np.median(widths) / 2.0)),
                "outside": "; ".join(named),
            }
        )
    return pd.DataFrame(rows)


def find_ratios(numbers: Array) -> Array:
    """Return velocity over position of what the motion causes, s^-2, shape (..., tables, schemes).

    numbers: the 64, x + y of which are noise + motion * amplitude^2. Tables 7 and 8 share their
    period, so they tell noise from motion; tables 6 and 9 have the noise of these. Where an error
    has one frequency, the ratio is that frequency's square, (rad/s)^2.
    """
    tables = numbers.reshape(*numbers.shape[:-1], len(TABLE_CELLS), len(SCHEMES), 2, 2).sum(axis=-1)
    squares = np.array([cell.amplitude**2 for cell in TABLE_CELLS.values()])
    _, low, high, _ = np.moveaxis(tables, -3, 0)
    slope = (high - low) / (squares[2] - squares[1])
    motion = tables - (low - slope * squares[1])[..., None, :, :]
    return np.asarray(motion[..., 1] / motion[..., 0])


def tabulate_ratios(
    likelihoods: Sequence[Likelihood], posteriors: Sequence[Posterior]
) -> pd.DataFrame:
    """Return per reading, table and scheme `find_ratios` of the print, and of records as predicted.

    Columns of the reading; table, scheme, printed, and low, median, high (95 % of records).
    Table 7 is left out: its ratio is table 8's.
    """
    printed, rows = find_ratios(print_of_tables()["published"].to_numpy(dtype=float)), []
    for likelihood, posterior in zip(likelihoods, posteriors, strict=True):
        ratios = find_ratios(np.exp(draw_records(likelihood, posterior)))
        ends = np.quantile(ratios, [0.025, 0.5, 0.975], axis=0)
        for place, table in enumerate(TABLE_CELLS):
            for column, scheme in enumerate(SCHEMES):
                named = dict(zip(("low", "median", "high"), ends[:, place, column], strict=True))
                found = {"table": table, "scheme": scheme, "printed": printed[place, column]}
                rows.append({**vars(likelihood.reading), **found, **named})
    table = pd.DataFrame(rows)
    return table[table["table"] != 7]
