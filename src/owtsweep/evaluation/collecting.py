"""Collects successive estimates into a trajectory of the quantities that a study judges."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.evaluation.estimate import Estimate, Quantity
from owtsweep.evaluation.trajectory import Trajectory


def collect(
    estimates: Iterable[Any], judged: Sequence[Quantity], steps: int, first: int = 0
) -> Trajectory:
    """Collect the estimates of some steps into a trajectory.

    Parameters
    ----------
    estimates
        One `Estimate` per step.
    judged
        The judged quantities, in the order of their components in the state.
    steps
        Number of estimates.
    first
        Number of the first of these steps, for error messages.

    Raises
    ------
    TypeError
        If an item is not an `Estimate`.
    ValueError
        If an estimate lacks a quantity, or one has the wrong shape. The message names the step.
    """
    size = sum(len(quantity.components) for quantity in judged)
    state = np.empty((steps, size))
    covariance: Array | None = None
    innovation: Array | None = None
    innovation_covariance: Array | None = None
    for k, estimate in enumerate(estimates):
        if not isinstance(estimate, Estimate):
            raise TypeError(f"update gave a {type(estimate).__name__}, not an owtsweep.Estimate")
        start = 0
        for name, components in judged:
            stop = start + len(components)
            state[k, start:stop] = _check_quantity(estimate, name, len(components), first + k)
            start = stop
        if estimate.covariance is not None:
            if covariance is None:
                covariance = np.full((steps, size, size), np.nan)
            covariance[k] = estimate.covariance
        if estimate.innovation is not None:
            value = np.asarray(estimate.innovation.value)
            if innovation is None or innovation_covariance is None:
                innovation = np.full((steps, len(value)), np.nan)
                innovation_covariance = np.full((steps, len(value), len(value)), np.nan)
            innovation[k] = value
            innovation_covariance[k] = estimate.innovation.covariance
    return Trajectory(state, covariance, innovation, innovation_covariance)


def _check_quantity(estimate: Estimate, name: str, size: int, step: int) -> Array:
    """A quantity of an estimate, (size,)."""
    if name not in estimate.quantities:
        raise ValueError(f"the estimate of step {step} has no {name}")
    array = np.asarray(estimate.quantities[name], dtype=float)
    if array.shape != (size,):
        raise ValueError(f"the {name} of step {step} has the shape {array.shape}, not ({size},)")
    return array
