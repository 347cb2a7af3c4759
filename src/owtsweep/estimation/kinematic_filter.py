"""Filter or smooth all degrees of freedom of a record whose accelerations are measured.

`kinematic` says what is modelled. Degrees of freedom have nothing in common but the times at which
their positions are reported.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.kinematic import Noise, State, filter_one
from owtsweep.estimation.kinematic_smoother import Links, filter_in_order, look_ahead


class Found(NamedTuple):
    """What a filter or smoother finds.

    estimate, covariance: of position and velocity, shapes (columns, steps, 2) and
        (columns, steps, 2, 2).
    nis: squared innovations of reports over their variance, shape (columns, steps); NaN where no
        report was used.
    """

    estimate: Array
    covariance: Array
    nis: Array


class Record(NamedTuple):
    """What is measured of several degrees of freedom, one per row.

    position: reported positions by arrival, shape (columns, steps), NaN where none arrives.
    shown: the time in samples that the report of a sample shows, shape (steps,).
    acceleration: shape (columns, steps).
    rate: for each column, measured rates (steps,), or an empty array.
    step: sampling interval in s.
    """

    position: Array
    shown: Array
    acceleration: Array
    rate: list[Array]
    step: float


#: Times closer than this to a sample, in samples, are those of the sample.
NEAR = 1e-6


def snap(times: Array) -> Array:
    """Return times in samples, those that miss a sample by rounding moved to it."""
    nearest = np.round(times)
    return np.where(np.abs(times - nearest) < NEAR, nearest, times)


def prepare(record: Record, noises: list[Noise], prior: Array) -> tuple[int, list[State], Found]:
    """Return the first report used, the states there, and arrays with what holds until then.

    That is the arrival of the first report that shows a time of the record; -1 if there is none.
    Until the first usable report, position is that of the first report of all (0 if there is none),
    velocity is 0, and variances are those of the prior: standard deviations of position, velocity
    and bias, shape (columns, 3).
    """
    columns, steps = record.position.shape
    there = np.all(np.isfinite(record.position), axis=0)
    usable = there & (record.shown >= 0.0) & (record.shown <= np.arange(steps))
    first = int(np.argmax(usable)) if usable.any() else -1
    at = record.position[:, np.argmax(there)] if there.any() else np.zeros(columns)
    found = Found(
        np.zeros((columns, steps, 2)),
        np.zeros((columns, steps, 2, 2)),
        np.full((columns, steps), np.nan),
    )
    found.estimate[:, :, 0] = at[:, None]
    for i in (0, 1):
        found.covariance[:, :, i, i] = prior[:, i, None] ** 2
    starts = zip(record.position[:, first].tolist(), noises, prior.tolist(), strict=True)
    states = [
        State(p, 0.0, 0.0, noise.position, 0.0, 0.0, velocity**2, 0.0, bias**2)
        for p, noise, (_, velocity, bias) in starts
    ]
    return first, states, found


def filter_all(record: Record, noises: list[Noise], prior: Array) -> Found:
    """Filter all degrees of freedom; parameters are those of `prepare`."""
    first, states, found = prepare(record, noises, prior)
    if first < 0:
        return found
    for c, noise in enumerate(noises):
        filter_one(
            record.position[c], record.shown, record.acceleration[c], record.rate[c], record.step,
            noise, first, states[c], (found.estimate[c], found.covariance[c], found.nis[c]),
        )  # fmt: skip
    return found


def smooth_all(record: Record, noises: list[Noise], prior: Array, lag: int) -> Found:
    """Estimate the states of all samples from what has arrived `lag` samples later; see `prepare`.

    With reports older than the lag, this is a filter that predicts by less.
    """
    first, starts, found = prepare(record, noises, prior)
    if first < 0:
        return found
    steps = record.position.shape[1]
    there = np.flatnonzero(np.all(np.isfinite(record.position), axis=0))
    there = there[there > first]
    age = np.arange(steps) - record.shown
    # A report that shows a time within the interval before sample k arrives floor(age) after k.
    window = lag - int(np.floor(max(age[there].max(initial=0.0), age[first])))
    if window < 0:
        return filter_all(arrive_earlier(record, lag), noises, prior)
    order = there[np.argsort(record.shown[there], kind="stable")]
    shown = record.shown[order]
    for c, noise in enumerate(noises):
        x, P = np.empty((steps, 3)), np.empty((steps, 3, 3))
        links = Links(np.zeros((steps, 3, 3)), np.zeros((steps, 3)), np.zeros((steps, 3, 3)))
        begin = filter_in_order(
            record.position[c, order], shown, order, record.acceleration[c], record.rate[c],
            record.step, noise, (record.shown[first], starts[c]), (x, P, links, found.nis[c]),
        )  # fmt: skip
        look_ahead(x, P, links, begin, window, found.estimate[c], found.covariance[c])
    return found


def arrive_earlier(record: Record, lag: int) -> Record:
    """Return the record with reports, and the times that they show, that arrive `lag` earlier."""
    position = np.full_like(record.position, np.nan)
    shown = np.full_like(record.shown, -np.inf)
    steps = len(shown)
    position[:, : steps - lag] = record.position[:, lag:]
    shown[: steps - lag] = record.shown[lag:]
    return record._replace(position=position, shown=shown)
