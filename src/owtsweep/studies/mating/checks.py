"""Checks that the values of the mating study's configuration can work together."""

from __future__ import annotations

from owtsweep.config import as_mapping, get_key, require
from owtsweep.studies.mating.config import MatingConfig
from owtsweep.studies.mating.joining import configure_blade, configure_hub

#: Keys of the other studies that this study sets.
OURS = (
    "study", "seed", "tuning", "schemes", "record.duration", "record.rate", "record.settling",
    "grid.sigma", "grid.outage", "sensors.gnss.sigma", "baselines",
    "measures.settling_time",
)  # fmt: skip


def check(config: MatingConfig) -> None:
    """Raise `InputError` if what can be known without the other studies does not fit together."""
    judged = config.record.duration - config.record.settling
    require(
        max(config.grid.hold) <= 0.5 * judged,
        f"grid.hold: {max(config.grid.hold):g} s are more than half of the {judged:g} s that are "
        "judged; give less, or a longer record",
    )


def check_outside(config: MatingConfig) -> None:
    """Raise `InputError` if a configuration of another study is refused, or both do not fit."""
    for name in ("blade", "hub"):
        for override in getattr(config, name):
            key = get_key(override)
            require(
                key not in OURS,
                f"{name}: {key} is set by the mating study; leave it out, and set the mating "
                "study's own key",
            )
    grid = config.grid
    for outage in grid.outage:
        blade = as_mapping(configure_blade(config, grid.sigma[0], outage, config.schemes))
    hub = as_mapping(configure_hub(config, grid.hub_sigma[0]))
    of_plant = hub["motion"]["kind"] == "plant"
    cells = {
        "blade": {f"grid.{axis}": blade["grid"][axis] for axis in blade["axes"]},
        "hub": {f"motion.{axis}": hub["motion"][axis] for axis in ("hs", "tp", "blades")}
        if of_plant
        else {f"grid.{axis}": hub["grid"][axis] for axis in ("natural_period", "amplitude")},
    }
    for name, axes in cells.items():
        for axis, values in axes.items():
            require(
                len(values or [0]) == 1,
                f"{name}: {axis} has {len(values or [0])} values, and the mating study takes one; "
                f"choose, e.g. '{name}=[\"{axis}=[{(values or [0])[0]:g}]\"]'",
            )
    imu_rate = hub["sensors"]["imu"]["rate"]
    ratio = imu_rate / config.record.rate
    require(
        round(ratio) >= 1 and abs(ratio - round(ratio)) < 1e-9,
        f"record.rate: {config.record.rate:g} Hz do not divide the {imu_rate:g} Hz of "
        "the hub's IMU; give a whole fraction of it",
    )
