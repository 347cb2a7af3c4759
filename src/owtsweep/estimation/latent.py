"""The augmented Kalman filter with latent forces: inputs are Gaussian processes in time.

Alvarez, Luengo and Lawrence (2009); as state-space models Hartikainen and Sarkka (2010). A process
with a Matern covariance of order 1/2 or 3/2 is a linear model with one or two states driven by
white noise. Here the process is sampled at the model's steps, where the discrete model is exact,
and the input is held over each step like any input of an `InputStateModel`. With r the time between
two values, the covariances are

    Matern 1/2:  sigma^2 exp(-r / length)
    Matern 3/2:  sigma^2 (1 + a r) exp(-a r),   a = sqrt(3) / length.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.linalg import block_diag

from owtsweep.arrays import Array
from owtsweep.estimation.augmented import augment
from owtsweep.estimation.input_state import Filter, InputStateModel, make_kalman

#: Prior variance of every state: next to nothing is known of states near 1.
WIDE = 1e6


def make_latent(
    model: InputStateModel,
    Q: Array,
    R: Array,
    kernel: Literal["matern12", "matern32"],
    sigma: Array,
    length: Array,
) -> Filter:
    """Make the augmented Kalman filter whose inputs are independent Gaussian processes.

    The filter's own states are those of the model, and one or two per input (with "matern32" value
    and rate times length / sqrt(3), input by input). Its `run` returns states, then inputs.

    Q, R: as of `augmented.make_augmented`.
    kernel: "matern12" (exponential correlation, rough paths) or "matern32" (paths with a rate).
    sigma: standard deviation of each input about zero, in the input's unit, shape (inputs,).
    length: correlation time of each input in s, shape (inputs,).
    The states begin with the variance `WIDE`, the inputs with `sigma`. Raises InputError if R is
    singular.
    """
    n, inputs = model.B.shape
    pieces = [_sample(kernel, s, model.step / t) for s, t in zip(sigma, length, strict=True)]
    transition = block_diag(*(piece[0] for piece in pieces))
    order = len(pieces[0][0])
    read = np.zeros((inputs, inputs * order))
    read[np.arange(inputs), order * np.arange(inputs)] = 1.0
    F, H = augment(model, transition, read)
    return make_kalman(
        F,
        H,
        block_diag(Q, *(piece[1] for piece in pieces)),
        R,
        block_diag(WIDE * np.eye(n), *(piece[2] for piece in pieces)),
        outputs=block_diag(np.eye(n), read),
    )


def _sample(kernel: str, sigma: float, ratio: float) -> tuple[Array, Array, Array]:
    """Sample a process: return transition, covariance of the noise, and stationary covariance.

    `ratio` is the step divided by the correlation time. The second state of Matern 3/2 is the rate
    divided by a, so that both states have the standard deviation sigma.
    """
    if kernel == "matern12":
        stationary = sigma**2 * np.eye(1)
        return np.exp(-ratio) * np.eye(1), -np.expm1(-2.0 * ratio) * stationary, stationary
    s = np.sqrt(3.0) * ratio
    fade = np.exp(-s)
    transition = fade * np.array([[1.0 + s, s], [-s, 1.0 - s]])
    # I - transition transition', with the leading terms of small s taken off by hand
    most = -np.expm1(-2.0 * s)
    noise = np.array(
        [
            [most - 2.0 * s * (1.0 + s) * fade**2, 2.0 * (s * fade) ** 2],
            [2.0 * (s * fade) ** 2, most + 2.0 * s * (1.0 - s) * fade**2],
        ]
    )
    return transition, sigma**2 * noise, sigma**2 * np.eye(2)
