"""What each source of error contributes to a scheme's mean square error, by simulation.

The schemes are linear. So an error is the sum of those from the motion, the fixes' noise, the
IMU's noise, the walk of its bias and its bias at the start. These are independent, so their mean
squares add (superposition); each grows with the square of its size. The sizes of motion and noises
then cost no run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np

from experiments.ren2019.posterior.settings import (
    LENGTHS,
    MOTIONS,
    OF_SCHEME,
    SETTLING,
    Reading,
    from_unit,
    make_tuning,
)
from owtsweep.arrays import Array
from owtsweep.config import with_values
from owtsweep.studies import compose
from owtsweep.studies.hub.batch import ChainRun
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.kernels.layout import WIDTH
from owtsweep.studies.hub.records import Feed, make_records
from owtsweep.studies.hub.sensors import sensors

#: Natural periods of tables 6 to 9, s.
PERIODS = (3.0, 4.0, 8.0)
#: Source of noise -> overrides that leave this source alone, of unit size. The last two are what
#: `TRUTH` in `settings` sizes.
SILENT = {"gnss.sigma": 1e-12, "imu.sigma": 1e-12, "imu.bias_walk": 0.0, "imu.bias_initial": 0.0}
SOURCES = {name: {**SILENT, name: 1.0} for name in SILENT}
#: How many settings run side by side on the records, which are made anew for each group.
TOGETHER = 8
#: The largest mean square that counts: a scheme that exceeds it diverges.
DIVERGED = 1e6


class Components(NamedTuple):
    """Mean squares of a scheme's errors, of position and velocity (the last axis).

    motion: along the wave, for a motion of 1 m, shape (motions, periods, lengths, 2, 2).
    noise: per axis, for noises of size one, shape (sources, lengths, 2, 2).
    The axis before the last: the whole record, and without its first `SETTLING` seconds.
    """

    motion: Array
    noise: Array


@cache
def base_config() -> HubConfig:
    """Return the hub's configuration with `tuning=paper`: its kinds of filters and of the MHE."""
    words = ["tuning=paper", f"record.duration={LENGTHS[-1]}", f"measures.settling_time={SETTLING}"]
    config = compose([*words, "seed=1842"])
    assert isinstance(config, HubConfig)
    return config


def make_chain(scheme: str, settings: Mapping[str, float], steps: int) -> Chain:
    """Return a scheme as arrays for the kernels, for values of the settings by name."""
    tuned = with_values(base_config(), make_tuning(scheme, dict(settings)))
    chain = resolve(scheme).kernel(Known(sensors(tuned.sensors), tuned), steps)
    assert isinstance(chain, Chain)
    return chain


def make_chains(settings: Mapping[str, float], steps: int) -> dict[str, Chain]:
    """Return scheme -> its chain, for values of all settings by name."""
    return {
        scheme: make_chain(scheme, {each.name: settings[each.name] for each in own}, steps)
        for scheme, own in OF_SCHEME.items()
    }


@cache
def _list_feeds() -> list[tuple[Feed, Array]]:
    """Return for each motion and period eight records, and the motions' peaks (lengths, WIDTH)."""
    base, feeds = base_config(), []
    noises = list(SOURCES.values())
    for number, ((force, spectrum), period) in enumerate(product(MOTIONS, PERIODS)):
        noise = noises[number] if number < len(noises) else SILENT
        motion = Reading(force=force, spectrum=spectrum).motion
        values = {**{f"sensors.{key}": value for key, value in noise.items()}, **motion}
        records = make_records(with_values(base, values), period, range(WIDTH))
        feed = Feed(records)
        feeds.append((feed, find_peaks(feed)))
    return feeds


def find_peaks(feed: Feed, lengths: Sequence[float] = LENGTHS) -> Array:
    """Return the largest displacement up to each length, m, shape (lengths, WIDTH)."""
    ends = count_steps(feed, lengths)
    motions = [feed.records.motion[index] for index in feed.indices]
    return np.array([[np.abs(m.position[:end]).max() for m in motions] for end in ends])


def count_steps(feed: Feed, lengths: Sequence[float]) -> list[int]:
    """Return lengths in steps."""
    return [round(length / feed.records.sensors.step) for length in lengths]


def sum_nested(
    chains: Sequence[Chain], feed: Feed, lengths: Sequence[float] = LENGTHS
) -> list[Array]:
    """Return of each chain sums of products of errors up to each length, (lengths, 2, 4, 3, WIDTH).

    The axes are those of `batch.products`, of x, y, vx and vy: before and after settling,
    quantity, product, record. All chains run on one span of the records before the next is made.
    """
    settled = round(SETTLING / feed.records.sensors.step)
    runs = [ChainRun(each, feed, settled) for each in chains]
    ends = count_steps(feed, lengths)
    found: list[list[Array]] = [[] for _ in runs]
    for span in feed.spans(max(run.lead for run in runs)):
        for run, sums in zip(runs, found, strict=True):
            run.advance(span)
            if run.done in ends:
                sums.append(run.products[:, :4].copy())
    assert all(len(sums) == len(ends) for sums in found)  # spans end where records do
    return list(map(np.array, found))


def average(sums: Array, feed: Feed, lengths: Sequence[float] = LENGTHS) -> Array:
    """Return means from `sum_nested`: the whole record and its settled part, same shape."""
    settled = round(SETTLING / feed.records.sensors.step)
    steps = np.array([[end, end - settled] for end in count_steps(feed, lengths)], dtype=float)
    both = np.stack([sums.sum(axis=1), sums[:, 1]], axis=1)
    return np.asarray(both / steps.reshape(*steps.shape, *[1] * (both.ndim - 2)))


def simulate(scheme: str, several: Sequence[Mapping[str, float]]) -> list[Components]:
    """Simulate the components of a scheme's errors at several settings; NaN where it diverges."""
    feeds = _list_feeds()
    chains = [make_chain(scheme, each, feeds[0][0].records.steps) for each in several]
    shape = (len(LENGTHS), 2, 2)
    motion = np.empty((len(chains), len(feeds), *shape))
    noise = np.empty((len(chains), len(SOURCES), *shape))
    with np.errstate(all="ignore"):
        for number, (feed, peaks) in enumerate(feeds):
            for chain, sums in enumerate(sum_nested(chains, feed)):
                means = average(sums, feed)
                # x and y together are the motion along the wave, for a motion whose peak is 1 m
                along = means[..., 0, :].reshape(*shape, 2, WIDTH).sum(axis=3)
                motion[chain, number] = (along / peaks[:, None, None] ** 2).mean(axis=-1)
                if number < len(SOURCES):
                    of_noise = means[..., 2, :].reshape(*shape, 2, WIDTH)
                    noise[chain, number] = of_noise.mean(axis=(3, 4))
    for part in (motion, noise):
        part[~(part < DIVERGED)] = np.nan
    motion = motion.reshape(len(chains), len(MOTIONS), len(PERIODS), *shape)
    return list(map(Components, motion, noise))


def simulate_all(scheme: str, unit: Array, workers: int = 2) -> list[Components]:
    """Simulate at points of the unit cube, shape (points, settings of the scheme)."""
    from joblib import Parallel, delayed

    settings = OF_SCHEME[scheme]
    values = from_unit(unit, settings)
    names = [setting.name for setting in settings]
    points = [dict(zip(names, row, strict=True)) for row in values]
    # not loky, which takes the records that each worker keeps for a leak of memory
    made = Parallel(workers, backend="multiprocessing")(
        delayed(simulate)(scheme, points[first : first + TOGETHER])
        for first in range(0, len(points), TOGETHER)
    )
    return [each for some in made for each in some]
