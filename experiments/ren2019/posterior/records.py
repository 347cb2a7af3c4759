"""How the 64 numbers of one record scatter about their means: schemes share motion and noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.special import gammaln

from experiments.ren2019 import published
from experiments.ren2019.evidence import SCHEMES, TABLE_CELLS
from experiments.ren2019.posterior.components import (
    PERIODS,
    average,
    base_config,
    find_peaks,
    make_chains,
    sum_nested,
)
from experiments.ren2019.posterior.settings import ACCURACIES, Reading
from experiments.ren2019.published import MEASURES, published_numbers
from experiments.single_record import read_rounded
from owtsweep.arrays import Array
from owtsweep.config import with_values
from owtsweep.results.superposition import superpose
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.kernels.layout import WIDTH
from owtsweep.studies.hub.records import Feed, make_records

#: Records from which scatter is computed, and the draws of the settings that share them.
RECORDS, DRAWS = 240, 10


@cache
def print_of_tables() -> pd.DataFrame:
    """Return the 64 numbers of tables 6 to 9, in the order of all arrays here.

    Table by table, scheme by scheme, x y vx vy. Columns as `published_numbers`, and `rounding`: the
    variance of the logarithm that comes from rounding to the printed digits.
    """
    table = published_numbers()
    table["rounding"] = (_last_digits() / table["published"].to_numpy()) ** 2 / 12.0
    return table


def _last_digits() -> Array:
    """The width of what rounds to each printed number, in the order of `print_of_tables`."""
    file = Path(published.__file__).with_name("ren2019_tables6to9_mse.csv")
    rows = pd.read_csv(file, dtype=str)
    found = {}
    for row in rows.to_dict("records"):
        for measure, column in MEASURES.items():
            least, greatest = read_rounded(str(row[column]))
            found[int(row["table"]), row["scheme"], measure] = greatest - least
    # the misprint 1.98e-2 has the digits of 1.98e-3
    found[7, "EKF", "vx"] /= 10.0
    return np.array(
        [found[t, s, m] for t in TABLE_CELLS for s in SCHEMES for m in MEASURES], dtype=float
    )


class Scatter(NamedTuple):
    """How the logarithms of the 64 numbers of one record are distributed about those of the means.

    offset: mean of the logarithm less logarithm of the mean, shape (64,).
    covariance: shape (64, 64), shrunk.
    freedom: degrees of freedom of Student's distribution that fits its tails best.
    """

    offset: Array
    covariance: Array
    freedom: float


def configure(reading: Reading, settings: Mapping[str, float]) -> HubConfig:
    """Return the configuration of records under a reading: accuracy, length and motion count."""
    base, share = base_config(), ACCURACIES[reading.accuracy]
    return with_values(
        base,
        {
            "sensors.gnss.sigma": base.sensors.gnss.sigma * share,
            "sensors.imu.sigma": base.sensors.imu.sigma * share,
            "sensors.imu.bias_walk": settings["bias_walk"],
            "sensors.imu.bias_initial": settings["bias_initial"],
            **reading.motion,
            "record.duration": reading.length,
            "seed": 77,
        },
    )


def simulate_records(reading: Reading, settings: Mapping[str, float], numbers: range) -> Array:
    """Return the 64 numbers of each record, shape (64, records). All tables share random numbers.

    reading: all but its seeds count. numbers: of the records, a multiple of eight of them.
    """
    assert len(numbers) % WIDTH == 0
    config = configure(reading, settings)
    steps = make_records(config, PERIODS[0], [0]).steps
    chains = make_chains(settings, steps)
    found = np.empty((len(TABLE_CELLS), len(SCHEMES), 4, len(numbers)))
    for first in range(0, len(numbers), WIDTH):
        some = numbers[first : first + WIDTH]
        for period in PERIODS:
            records = make_records(config, period, some)
            feed = Feed(replace(records, in_streams=(0.0,)))  # equal random numbers at all periods
            means, peaks = measure(chains, feed, reading)
            for line, cell in enumerate(TABLE_CELLS.values()):
                if cell.natural_period == period:
                    motion, cross, noise = np.moveaxis(means, 2, 0)
                    mse = superpose(motion, cross, noise, cell.amplitude / peaks)
                    found[line][..., first : first + WIDTH] = mse
    return found.reshape(-1, len(numbers))


def measure(chains: Mapping[str, Chain], feed: Feed, reading: Reading) -> tuple[Array, Array]:
    """Return means of products of errors (schemes, 4, 3, WIDTH), and the motions' peaks (WIDTH,).

    Over the record of a reading, with or without its start; axes as `components.sum_nested`.
    """
    lengths, window = (reading.length,), 0 if reading.start else 1
    sums = sum_nested([chains[scheme] for scheme in SCHEMES], feed, lengths)
    means = [average(each, feed, lengths)[0, window] for each in sums]
    return np.array(means), find_peaks(feed, lengths)[0]


def find_scatter(numbers: Array, reading: Reading) -> Scatter:
    """Return the scatter of single records under a reading.

    numbers: from `simulate_records` at each draw of the settings, shape (draws, 64, records).
    Deviations are those from the mean of the own draw.
    """
    logs = np.log(numbers)
    offset = np.mean(logs.mean(axis=2) - np.log(numbers.mean(axis=2)), axis=0)
    deviations = np.hstack(list(logs - logs.mean(axis=2, keepdims=True)))
    count = deviations.shape[1]
    deviations *= np.sqrt((count - 1) / (count - len(numbers)))  # each draw costs a mean
    covariance = shrink(deviations.T)
    if reading.seeds == "own":
        table = print_of_tables()["table"].to_numpy()
        covariance = np.where(table[:, None] == table, covariance, 0.0)
    return Scatter(offset, covariance, fit_freedom(deviations, covariance))


def shrink(rows: Array) -> Array:
    """Return the covariance of rows, shape (records, n), shrunk to its diagonal.

    Schaefer and Strimmer (2005), Stat. Appl. Genet. Mol. Biol. 4, 32: target D of their table 2.
    """
    count = len(rows)
    standard = (rows - rows.mean(axis=0)) / rows.std(axis=0, ddof=1)
    pairs = standard[:, :, None] * standard[:, None, :]
    correlation = pairs.sum(axis=0) / (count - 1)
    variance = pairs.var(axis=0, ddof=1) * count / (count - 1) ** 2
    off = ~np.eye(rows.shape[1], dtype=bool)
    part = float(np.clip(variance[off].sum() / (correlation[off] ** 2).sum(), 0.0, 1.0))
    correlation = np.where(off, (1.0 - part) * correlation, 1.0)
    deviation = rows.std(axis=0, ddof=1)
    return np.asarray(correlation * deviation[:, None] * deviation)


def fit_freedom(deviations: Array, covariance: Array) -> float:
    """Return the degrees of freedom with which Student's distribution fits records best.

    deviations: from the mean, shape (n, records). The distribution has this covariance.
    """
    solved = np.linalg.solve(covariance, deviations)
    distances = np.sum(deviations * solved, axis=0)
    choices = np.geomspace(2.5, 4000.0, 81)
    likely = [log_student(distances, len(deviations), nu).sum() for nu in choices]
    return float(choices[int(np.argmax(likely))])


def log_student(distance: Array, size: int, freedom: float) -> Array:
    """Return Student's log density without its determinant, given a covariance (not a scale).

    distance: squared Mahalanobis distances d' C^-1 d.
    """
    scale = freedom - 2.0
    constant = (
        gammaln((freedom + size) / 2) - gammaln(freedom / 2) - size / 2 * np.log(scale * np.pi)
    )
    return np.asarray(constant - (freedom + size) / 2 * np.log1p(distance / scale))
