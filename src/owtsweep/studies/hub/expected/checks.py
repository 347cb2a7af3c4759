"""Refuses settings with which the engine `expected` cannot work."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.errors import require
from owtsweep.studies.hub.contract import Scheme

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig


def check_expected(config: HubConfig, schemes: Sequence[Scheme]) -> None:
    """Raise InputError for settings with which the engine `expected` cannot work.

    This engine simulates no records. It computes from the schemes' kernels, but for SKF.
    """
    require(
        not config.measures.extremes,
        "measures.extremes: largest errors need records; use engine=batch",
    )
    require(
        config.evaluation == "superposed",
        "evaluation: engine=expected runs no record, so it cannot run amplitudes directly; use "
        "evaluation=superposed, or engine=batch",
    )
    require(
        config.sensors.imu.high_pass is None,
        "sensors.imu.high_pass: engine=expected cannot shift the phase of the force, as an AC "
        "coupling does; use engine=batch",
    )
    for fault, there in _list_faults(config).items():
        require(
            not there,
            f"sensors.gnss.{fault}: engine=expected knows white noise of fixes that all arrive; "
            f"use engine=batch, or leave {fault} at its default",
        )
    from owtsweep.studies.hub.schemes.skf import SpectralScheme

    for scheme in schemes:
        if isinstance(scheme, SpectralScheme):
            _check_skf(config, scheme.name)
            continue
        require(
            scheme.linear and scheme.batched == "chain",
            f"schemes: {scheme.name} has no kernel or is not linear, and engine=expected needs a "
            "linear scheme with a kernel; use `sweep` with engine=batch, or leave the scheme out "
            "(HME2 is linear if hme.mhe.constraints is null, every scheme only with "
            "fix_rule=plain)",
        )


def _check_skf(config: HubConfig, name: str) -> None:
    """Raise InputError unless SKF has errors that do not depend on the length of the record."""
    require(
        config.measures.window == "settled",
        f"measures.window: engine=expected knows the errors of {name} once they have settled, not "
        f"those of its start; use measures.window=settled, or leave {name} out of schemes",
    )
    walk = config.sensors.imu.bias_walk if config.skf.q_b is None else config.skf.q_b
    require(
        walk > 0.0,
        f"schemes: without a bias walk {name} never settles, so engine=expected has no error to "
        "tell; give skf.q_b above zero, e.g. skf.q_b=1e-6, or leave SKF out of schemes",
    )


def _list_faults(config: HubConfig) -> dict[str, bool]:
    """Return key of sensors.gnss -> whether it sets a fault that theory of white noise lacks."""
    gnss = config.sensors.gnss
    return {
        "outliers": gnss.outliers.rate > 0.0,
        "loss": gnss.loses,
        "correlation": gnss.correlation.sigma > 0.0,
    }
