"""What schemes are told of a case: noise, bias, delay, and how the structure moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from owtsweep.studies.floater.case import Conditions
from owtsweep.studies.floater.contract import DOF, Setting
from owtsweep.studies.floater.measuring import DRIFT_TIME, find_sigmas, scale_accelerations
from owtsweep.studies.floater.truth import Motion

if TYPE_CHECKING:
    from owtsweep.studies.floater.config import FloaterConfig


def make_setting(config: FloaterConfig, motion: Motion, conditions: Conditions) -> Setting:
    """Return what schemes know beforehand of a case, by the section `filters`."""
    tuning, truth, body = config.filters, motion.truth, config.sensors.frame == "body"
    sigmas = find_sigmas(config, motion, conditions.snr)
    wrong = np.sqrt(conditions.believed)
    size = scale_accelerations(config, motion)
    noise = tuning.process_share * size if tuning.process == "declared" else sigmas.acceleration
    share = tuning.bias_share if tuning.bias == "ignored" else conditions.bias
    drift = config.sensors.bias_drift if tuning.bias == "truth" else 0.0
    bias, walk = share * size, drift / np.sqrt(DRIFT_TIME) * size
    if body:  # angular accelerations are not measured: they are themselves the noise
        noise = np.concatenate(
            [noise, tuning.angular_share * truth.acceleration[:, 3:].std(axis=0)]
        )
        bias, walk = (np.concatenate([each, np.zeros(3)]) for each in (bias, walk))
    delay = {
        "ignored": 0.0,
        "declared": tuning.delay_declared,
        "truth": conditions.delay * truth.step,
    }[tuning.delay]
    moved = [part.std(axis=0) for part in (truth.position, truth.velocity, truth.acceleration)]
    return Setting(
        step=truth.step,
        position_sigma=wrong * sigmas.position,
        rate_sigma=wrong * sigmas.rate,
        acceleration_sigma=noise,
        bias_sigma=bias,
        bias_walk=walk,
        delay=delay,
        motion_sigma=np.stack(moved),
        frequency=_find_frequencies(config, motion),
        body=body,
        zeros=config.sensors.lost_as == "zeros",
        tuning=tuning,
        start=None
        if tuning.start == "report"
        else np.stack([truth.position[0], truth.velocity[0]]),
    )


def _find_frequencies(config: FloaterConfig, motion: Motion) -> np.ndarray:
    """Return natural frequencies in rad/s, (6,); of a recorded motion that of zero crossings."""
    if config.motion.kind == "recorded":
        truth = motion.truth
        return np.asarray(truth.velocity.std(axis=0) / truth.position.std(axis=0))
    periods = [config.motion.freedoms[name].resonance.period for name in DOF]
    return 2.0 * np.pi / np.array(periods)
