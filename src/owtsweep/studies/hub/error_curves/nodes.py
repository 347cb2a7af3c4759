"""Chooses the nodes at which a curve is computed: first a coarse set, then more where needed.

A curve is a scheme's error over frequency. Nodes are frequencies or numbers of basis vectors. A
curve may ripple (due to a memory that ends abruptly), have a peak (due to a poorly damped mode), or
change within a range of frequencies as small as one over the record's duration (due to a slow mode,
at multiples of the fix rate). The first nodes are dense enough to show all of these features.
Intervals between nodes are then halved until interpolation is accurate enough.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.sensors import Sensors

#: Number of first nodes per ripple, before any interval is halved.
PER_RIPPLE = 2.5
#: Widest spacing of the first nodes below the fix rate, in units of the fix rate, and number of
#: first nodes per decade above the fix rate.
WIDEST = 0.02
PER_DECADE = 8
#: Greatest number of times that an interval is halved.
HALVINGS = 7


@dataclass(frozen=True)
class Scales:
    """The widths (Hz) of the finest features of a scheme's error curves over frequency.

    window: due to the scheme's longest memory, the window of the MHE; seen below the fix rate.
    lag: due to the smoother and the predictor; seen at higher frequencies, which only the IMU
        measures.
    rate: the fix rate.
    """

    window: float
    lag: float
    rate: float


def scales(chain: Chain, sensors: Sensors) -> Scales:
    """Compute the widths of the finest features of a chain's error curves over frequency."""
    rate = 1.0 / sensors.fix_step
    window = chain.mhe.horizon * sensors.fix_step if chain.mhe.active else 0.0
    lag = (chain.filter.window + chain.predictor.steps) * sensors.step
    widest = WIDEST * rate * PER_RIPPLE
    return Scales(min(1.0 / max(window, 1e-9), widest), 1.0 / max(lag, 1e-9), rate)


def over_band(band: Sequence[float], scales: Scales, duration: float) -> Array:
    """Return the first nodes in a band, both edges included, Hz, increasing.

    `duration` is that of a record, s.
    """
    low, high = band
    nodes = [np.geomspace(low, high, 8), _evenly(low, high, scales.window / PER_RIPPLE)]
    centres = scales.rate * np.arange(1, int(high / scales.rate) + 2)
    offsets = np.geomspace(0.25 / duration, 0.5 * scales.window, 10)
    nodes.append(np.add.outer(centres, [*-offsets, 0.0, *offsets]).ravel())
    frequency = np.unique(np.concatenate(nodes))
    frequency = frequency[(frequency >= low) & (frequency <= high)]
    return np.asarray(frequency[np.diff(frequency, prepend=-np.inf) > 1e-9 * high])


def numbers(last: int, per_number: float, scales: Scales) -> Array:
    """Return the first nodes among the basis vectors number 1 ... last: whole numbers, increasing.

    The frequency of a basis vector is its number times `per_number`, Hz.
    """
    decades = np.log10(max(last, 2))
    nodes = [np.arange(1.0, min(last, 3) + 1.0), np.geomspace(1, last, int(PER_DECADE * decades))]
    for spacing, top in ((scales.window, scales.rate), (scales.lag, 6.0 * scales.lag)):
        nodes.append(_evenly(1.0, min(top / per_number, last), spacing / PER_RIPPLE / per_number))
    number = np.unique(np.rint(np.concatenate(nodes)))
    return np.asarray(number[(number >= 1) & (number <= last)])


def _evenly(low: float, high: float, spacing: float) -> Array:
    high = max(low, high)
    return np.linspace(low, high, int(np.ceil((high - low) / max(spacing, 1e-12))) + 1)


def refined(
    nodes: Array,
    values: Array,
    answer: Callable[[Array], Array],
    large: Callable[[Array, Array, Array, Array], Array],
    *,
    whole: bool = False,
) -> tuple[Array, Array]:
    """Halve the intervals between nodes, at most `HALVINGS` times, until interpolation is accurate.

    nodes, values: the first n nodes, increasing, and the curve's values there, shape (..., n).
    answer: function of nodes that computes the curve's values at the nodes.
    large: function of (left, right, part, values): ends of intervals, and an error and the curve's
        values in their middles. It says for each interval whether an error of this size matters. An
        interval in which the whole curve does not matter is not halved.
    whole: whether nodes must be whole numbers.
    Returns: all nodes, increasing, and the curve's values there.
    """
    left, right = nodes[:-1], nodes[1:]
    for _ in range(HALVINGS):
        middle = np.sqrt(left * right)
        if whole:
            middle = np.rint(middle)
            inside = (middle > left) & (middle < right)
            left, right, middle = left[inside], right[inside], middle[inside]
        predicted = between(middle, nodes, values)
        some = large(left, right, predicted, predicted)
        left, middle, right, predicted = left[some], middle[some], right[some], predicted[..., some]
        if not len(middle):
            break
        computed = answer(middle)
        missed = large(left, right, np.abs(predicted - computed), computed)
        order = np.argsort(np.append(nodes, middle), kind="stable")
        nodes = np.append(nodes, middle)[order]
        values = np.concatenate([values, computed], axis=-1)[..., order]
        left, middle, right = left[missed], middle[missed], right[missed]
        left, right = np.sort([*left, *middle]), np.sort([*middle, *right])
    return nodes, values


def between(x: Array, at: Array, values: Array) -> Array:
    """Interpolate curves that are nowhere negative at x, given values (..., n) at the n nodes `at`.

    Interpolation is by monotone cubics in the logarithms of both axes. Beyond the nodes, curves are
    constant. A curve that is zero stays zero: a baseline has no error due to noise that it does not
    use.
    """
    from scipy.interpolate import PchipInterpolator

    least = np.finfo(float).tiny  # stands for 0, which has no logarithm
    logs = np.log(np.maximum(values, least))
    if len(at) < 2:
        result = np.exp(np.repeat(logs, len(x), axis=-1))
    else:
        curve = PchipInterpolator(np.log(at), logs, axis=-1)
        result = np.exp(curve(np.log(np.clip(x, at[0], at[-1]))))
    return np.where(result > 2.0 * least, result, 0.0)
