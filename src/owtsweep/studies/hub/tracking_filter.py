"""Filters one axis with the model that the motion so far makes likely.

Every ten seconds the tracker examines the specific force. When it chooses another model, the filter
of this model starts a minute ago, from its own prior, filters that minute's measurements again, and
goes on from there. So no state is handed from one model to another, but for the IMU's bias.

Beside it runs a filter that assumes next to nothing of the motion. It takes over if the innovations
of the last minute's fixes are larger than the model can explain, if there is motion above the band
that the model does not know and that matters beside the error that it states, or if, in a large
motion, it predicted the fixes of the last minutes clearly better. It takes over at once if the
innovations of the last few fixes, or an IMU sample, are far too large, as when a calm hub is
struck.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array, Past
from owtsweep.estimation.weighing import Weighing
from owtsweep.motion.candidates import Fixes, Sea
from owtsweep.motion.tracking import INTERVAL, OF_SHAPE, Motion, SpectrumTracker
from owtsweep.studies.hub.fix_noise_tracking import FixNoiseTracker, find_level
from owtsweep.studies.hub.lean_tracking import LeanTracker
from owtsweep.studies.hub.scheme_sections import Skf
from owtsweep.studies.hub.sensors import Sensors
from owtsweep.studies.hub.spectral_filter import AxisEstimates, AxisFilter, join
from owtsweep.studies.hub.spectral_model import SpectralAxis
from owtsweep.studies.hub.tracked_models import make_sea_model

#: Time that a new model filters again, s, and the standard deviation of the bias that it starts
#: with, m/s^2.
AGAIN, BIAS_SIGMA = 60.0, 0.02
#: Probability that a right model passes the guard, and the greatest variance of unknown motion
#: above the band per variance of the stated error.
CONFIDENCE, UNKNOWN = 0.999, 0.5
#: Number of the last few fixes, and the probability that a right model fails their test; it also
#: bounds how often a right model is given up because the other filter predicted fixes better.
FEW, ALARM = 4, 1e-5
#: The variance of a motion, m^2, up to which a gate is patient and red noise is tracked. A larger
#: one leaves more doubt of the model than of the fixes: there, one fix in a row is refused.
CALM = 0.2
#: The variance, m^2, up to which fixes help the IMU to see the spectrum. In a larger motion they
#: are not needed, and an outlier that was not refused would be taken for motion.
FAINT = 0.01
#: At each how many looks the lean is looked at, which hardly ever changes.
LOOKS_AT_LEAN = 3
#: How many standard deviations an IMU sample may be off the bias.
FAR = 6.0
#: Rows of what is kept of fixes: as measured, and what each of two filters made of them: with
#: refused ones replaced by its predictions, and their log likelihoods. Of the filter that assumes
#: next to nothing, also the squares of the scaled innovations, refused or not.
FIXES, KEPT, LIKELY, KEPT_WIDE, LIKELY_WIDE, FAR_WIDE = range(6)


class Told(NamedTuple):
    """What a filter is told of the measurements.

    red: standard deviation of the fixes' red noise, m.
    white: the fixes' white noise over what it is said to be.
    lean: specific force by leaning, s^-2.
    """

    red: float
    white: float
    lean: float


class TrackingFilter:
    """A filter of one axis that is given nothing of the motion.

    band: edges of the band of the motion, Hz.
    rule: how much a fix counts that is far from its prediction.
    start: returns a new filter of a model, given the model, the rule, and the bias to start with,
        m/s^2.
    """

    def __init__(
        self,
        tuning: Skf,
        sensors: Sensors,
        band: tuple[float, float],
        rule: Weighing,
        start: Callable[[SpectralAxis, Weighing, float], AxisFilter],
    ) -> None:
        self._tuning, self._sensors, self._band = tuning, sensors, band
        self._rule, self._start = rule, start
        # a large motion leaves no doubt of a fix alone: the state may be as wrong
        self._hasty_rule = rule._replace(patience=min(rule.patience, 1))
        lean = tuning.find_lean(sensors.lean)
        self._tracker = SpectrumTracker(sensors.step, sensors.force_sigma, lean, band)
        self._delay = sensors.delay * sensors.step
        # None: the red noise of the fixes is declared
        self._noise_tracker: FixNoiseTracker | None = None
        if tuning.red_sigma is None:
            self._noise_tracker = FixNoiseTracker(sensors.fix_step, tuning.red_time, band)
        # None: the tilt is declared
        self._lean_tracker: LeanTracker | None = None
        if tuning.track_tilt:
            steps = self._tracker.step, sensors.fix_step
            self._lean_tracker = LeanTracker(steps, self._delay, sensors.position_sigma, band, lean)
        between = int(np.ceil(INTERVAL / sensors.fix_step - 1e-9))
        self._between = between * sensors.fix_interval
        looks = int(np.ceil(AGAIN / (self._between * sensors.step) - 1e-9))
        self._again = looks * self._between
        kept = max(self._again, round(OF_SHAPE / sensors.step)) + self._between
        self._interval, self._steps = sensors.fix_interval, 0
        # at all steps, and at those at which a fix is due: twice as many, for the level of noise
        self._measured = Past(2, kept)
        self._judged = Past(6, 2 * kept // self._interval)
        self._last = slice(-(kept // self._interval), None)
        # steps and biases at the looks of the last minute
        self._biases = deque([(0, 0.0)], maxlen=looks + 2)
        # squared scaled innovations: between the looks, since the last look, of the last few
        self._scores: deque[Array] = deque(maxlen=looks)
        self._fresh: list[Array] = []
        self._few: Array = np.empty(0)
        #: The sea that is assumed; None while next to nothing is.
        self.model: Sea | None = None
        #: What is likely of noise and lean now, and what the filter in use was told.
        self.told = self._in_use = Told(tuning.red_sigma or 0.0, 1.0, lean)
        self._level_at = 0  # the step from which on the white noise in use shows in what is kept
        axis = self._make(None, tuning.bias_variance)
        self._wide = self._filter = start(axis, self._hasty_rule, 0.0)
        self._was_beaten = False
        self._force_sigma = np.inf  # of an IMU sample, by the model
        self._stated = np.zeros((2, 2))  # covariance of the last estimate

    @property
    def bias(self) -> float:
        return self._filter.bias

    def take(self, force: Array, fixes: Array) -> AxisEstimates:
        parts, done = [], 0
        while done < len(force):
            stop = min(done + self._between - self._steps % self._between, len(force))
            parts.append(self._follow(force[done:stop], fixes[done:stop]))
            done += len(parts[-1].state)
            if self._steps % self._between == 0:
                self._look()
        return join(parts)

    def _follow(self, force: Array, fixes: Array) -> AxisEstimates:
        """Take measurements until the next look, or until one contradicts the model, inclusive."""
        result = self._filter.take(force, fixes)
        steps = len(force)
        due = np.arange(-self._steps % self._interval, steps, self._interval)
        innovations = _pick(result, due)
        scores = _score(innovations)
        is_alarmed = False
        if self.model is not None:
            struck = np.flatnonzero(np.abs(force - self._biases[-1][1]) > FAR * self._force_sigma)
            late = _find_alarm(self._few, scores)
            ends = [int(struck[0])] if len(struck) else []
            if late is not None:
                ends.append(int(due[innovations.weight > 0.0][late]))
            if ends:
                is_alarmed, steps = True, min(ends) + 1
                result = AxisEstimates(*(array[:steps] for array in result))
                due = due[due < steps]
                innovations = _pick(result, due)
                scores = _score(innovations)
        force, fixes = force[:steps], fixes[:steps]
        wide = innovations
        if self.model is not None:
            wide = _pick(self._wide.take(force, fixes), due)
        measured = fixes[due]
        self._measured.add([force, fixes])
        of_wide = *_judge(measured, wide), wide.square
        self._judged.add([measured, *_judge(measured, innovations), *of_wide])
        self._steps += steps
        self._fresh.append(scores)
        self._few = np.concatenate([self._few, scores])[-(FEW - 1) :]
        self._stated = result.covariance[-1]
        if is_alarmed:
            self._give_up()
        return result

    def _look(self) -> None:
        """Look at the spectrum, and change the model if another is likely or this one is wrong."""
        self._biases.append((self._steps, self._filter.bias))
        self._scores.append(np.concatenate([np.empty(0), *self._fresh]))
        self._fresh = []
        force = self._tracker.average(self._measured.values[0])
        judged = self._judged.values[:, self._last]
        white = self._find_white()
        sigma = white * self._sensors.position_sigma
        noise = sigma, self.told.red, self._tuning.red_time
        of_fixes = Fixes(self._sensors.fix_step, self._delay, *noise)
        is_faint = self.model is not None and _sum_variances(self.model) < FAINT
        wanted = self._tracker.look(force, (judged[KEPT], of_fixes) if is_faint else None)
        above = self._tracker.above
        is_calm = wanted is None or _is_calm(wanted)
        red = self._find_red(judged[KEPT], sigma, is_calm)
        told = Told(red, white, self._find_lean(force, judged[FIXES]))
        if told != self.told:
            self.told, self._tracker.lean = told, told.lean
            self._tell_wide()
        if wanted is not None and (wanted, told) != (self.model, self._in_use):
            self._change(wanted, above)
        if self.model is not None:
            scores = np.concatenate([*self._scores, *self._fresh])
            self._was_beaten = _is_beaten(judged)
            if self._was_beaten or _is_contradicted(scores) or _is_blind(self._stated, above):
                self._give_up()

    def _find_white(self) -> float:
        """Return the level of the fixes' white noise that is likely, over what it is said to be."""
        now, fixes = self.told.white, (self._steps - self._level_at) // self._interval
        level = find_level(self._judged.values[FAR_WIDE, -fixes:], now)
        if level != now:
            self._level_at = max(self._steps - self._again, 0)
        return level

    def _find_red(self, fixes: Array, sigma: float, is_calm: bool) -> float:
        """Return the size of the red noise, m, that fixes (n,) make likely.

        sigma: standard deviation of the fixes' white noise, m.
        is_calm: whether the motion is so small that red noise can be told from it.
        """
        if self._noise_tracker is None:
            return self.told.red
        return self._noise_tracker.look(fixes, sigma) if is_calm else self._noise_tracker.forget()

    def _find_lean(self, force: Array, fixes: Array) -> float:
        """Return the lean, s^-2, that the averaged force (n,) and fixes (m,) make likely."""
        if self._lean_tracker is None or self._steps // self._between % LOOKS_AT_LEAN:
            return self.told.lean
        return self._lean_tracker.look(force, fixes)

    def _change(self, model: Sea, above: Motion) -> None:
        """Filter the last minute again with another model, and go on with it unless it is wrong.

        After a model was beaten by the filter that assumes next to nothing, the next one must have
        predicted the fixes better. If there is news of noise or lean, that filter has predicted the
        minute again, so the new predictions of this one count too.
        """
        rule = self._rule if _is_calm(model) else self._hasty_rule
        axis, filter, again, result = self._filter_again(model, rule)
        innovations = _pick(result, slice(None, None, self._interval))
        scores, stated = _score(innovations), result.covariance[-1]
        kept, likely = _judge(again[FIXES], innovations)
        # a filter that has just started predicts badly
        gains = (likely - again[LIKELY_WIDE])[len(likely) // 2 :]
        if self._was_beaten and np.nansum(gains) <= 0.0:
            return
        if not (_is_contradicted(scores) or _is_blind(stated, above)):
            again[KEPT] = kept
            if self.told != self._in_use:
                again[LIKELY] = likely
            self.model, self._in_use = model, self.told
            self._filter, self._stated = filter, stated
            self._was_beaten = False
            self._force_sigma = _compute_force_sigma(axis)
            self._scores.clear()
            self._fresh, self._few = [scores], scores[-(FEW - 1) :]

    def _give_up(self) -> None:
        """Go on with the filter that assumes next to nothing of the motion."""
        self.model, self._in_use, self._filter = None, self.told, self._wide
        judged = self._judged.values
        judged[[KEPT, LIKELY]] = judged[[KEPT_WIDE, LIKELY_WIDE]]

    def _tell_wide(self) -> None:
        """Let the filter that assumes next to nothing know noise and lean as they are now."""
        _, self._wide, again, result = self._filter_again(None, self._hasty_rule)
        innovations = _pick(result, slice(None, None, self._interval))
        again[KEPT_WIDE:] = [*_judge(again[FIXES], innovations), innovations.square]
        if self.model is None:
            self._give_up()

    def _filter_again(
        self, model: Sea | None, rule: Weighing
    ) -> tuple[SpectralAxis, AxisFilter, Array, AxisEstimates]:
        """Start a filter a minute ago; return its model, itself, that minute, and its estimates.

        Of that minute, what is kept of the fixes is returned.
        """
        first = max(self._steps - self._again, 0)
        bias = next(bias for step, bias in reversed(self._biases) if step <= first)
        variance = BIAS_SIGMA**2 if first else self._tuning.bias_variance
        axis = self._make(model, variance)
        filter = self._start(axis, rule, bias)
        steps = self._steps - first
        again = self._judged.values[:, -(steps // self._interval) :]
        return axis, filter, again, filter.take(*self._measured.values[:, -steps:])

    def _make(self, model: Sea | None, bias_variance: float) -> SpectralAxis:
        red, white, lean = self.told
        return make_sea_model(
            model, bias_variance, self._tuning, self._sensors, self._band, red, lean, white
        )


def _sum_variances(sea: Sea) -> float:
    return sum(peak.values[2] for peak in sea)


def _is_calm(sea: Sea) -> bool:
    return _sum_variances(sea) < CALM


class _Innovations(NamedTuple):
    """Innovations of fixes that were due, their variances, and their weights, shape (fixes,)."""

    innovation: Array
    variance: Array
    weight: Array

    @property
    def square(self) -> Array:
        """The squares of the scaled innovations, NaN without a fix."""
        return self.innovation**2 / self.variance


def _pick(estimates: AxisEstimates, due: slice | NDArray[np.int64]) -> _Innovations:
    return _Innovations(*(array[due] for array in estimates[2:]))


def _score(innovations: _Innovations) -> Array:
    """Return the weighed squares of the innovations over their variances, shape (fixes,).

    A fix that is refused has none: it says nothing of the model. One that is taken after too many
    were refused has its full square, by which the guard gives the model up.
    """
    there = innovations.weight > 0.0
    return np.asarray((innovations.weight * innovations.square)[there])


def _judge(fixes: Array, innovations: _Innovations) -> tuple[Array, Array]:
    """Return fixes, those that were refused as predicted, and their log likelihoods.

    A fix that is far off counts as one at the edge of what a right model lets through; one that is
    refused does not count.
    """
    innovation, variance, weight = innovations
    is_refused = weight == 0.0
    squares = np.minimum(innovations.square, _find_limit(1, 1.0 - CONFIDENCE))
    likely = np.where(is_refused, np.nan, -0.5 * (np.log(variance) + squares))
    return np.where(is_refused, fixes - innovation, fixes), likely


def _is_beaten(judged: Array) -> bool:
    """Return whether the other filter predicted fixes clearly better, since any time in the past.

    That is Page's test. Under a right model, the chance that a likelihood ratio ever reaches r is
    at most 1 / r (Ville 1939).
    """
    gains = judged[LIKELY] - judged[LIKELY_WIDE]
    return bool(np.min(np.cumsum(gains[~np.isnan(gains)][::-1]), initial=0.0) < np.log(ALARM))


def _is_contradicted(scores: Array) -> bool:
    """Return whether the sum of squared scaled innovations, or of the last few, is no chance."""
    count = len(scores)
    is_large = count > 0 and np.sum(scores) > _find_limit(count, 1.0 - CONFIDENCE)
    return bool(is_large) or _find_alarm(np.empty(0), scores) is not None


def _find_alarm(before: Array, scores: Array) -> int | None:
    """Return the index of the first score that, with the few before it, is far too large."""
    sums = np.convolve(np.concatenate([before, scores]), np.ones(FEW))[len(before) :]
    far = np.flatnonzero(sums[: len(scores)] > _find_limit(FEW, ALARM))
    return int(far[0]) if len(far) else None


@lru_cache(256)
def _find_limit(count: int, probability: float) -> float:
    """Return what a chi-squared sum of `count` squares exceeds with a probability."""
    from scipy.special import chdtri

    return float(chdtri(count, probability))


def _is_blind(stated: Array, above: Motion) -> bool:
    """Return whether motion above the band matters beside the stated covariance (2, 2)."""
    variances = UNKNOWN * np.diagonal(stated)
    return bool(above.position > variances[0] or above.velocity > variances[1])


def _compute_force_sigma(axis: SpectralAxis) -> float:
    """Compute the standard deviation of an IMU sample without bias, m/s^2."""
    model = axis.model
    n = len(model.Q)
    return float(np.sqrt(model.fast @ axis.first[:n, :n] @ model.fast + model.r_fast))
