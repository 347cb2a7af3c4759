"""One replicate of one record with all schemes' estimates: what files and figures are made of."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.schemes import resolve_all
from owtsweep.studies.hub.sensors import Measurements
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import Estimated, estimate
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.measuring import measure
from owtsweep.studies.replay.record import Record


@dataclass(frozen=True)
class Session:
    """A record, what the sensors said in replicate 0, and what the schemes made of it.

    Attributes
    ----------
    failed
        Scheme -> why it has no estimates.
    """

    record: Record
    sensors: Sensors
    measured: Measurements
    estimated: Mapping[str, Estimated]
    failed: Mapping[str, str]


def session(config: ReplayConfig, file: str) -> Session:
    """Run all schemes over replicate 0 of a record.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    record = load_record(config, file)
    sensors = sensing.sensors(config.sensors)
    measured = measure(config, sensors, record, 0)
    found = dict(each(config, sensors, measured))
    return Session(
        record,
        sensors,
        measured,
        {name: item for name, item in found.items() if isinstance(item, Estimated)},
        {name: item for name, item in found.items() if isinstance(item, str)},
    )


def each(
    config: ReplayConfig, sensors: Sensors, measured: Measurements
) -> Iterator[tuple[str, Estimated | str]]:
    """Run the schemes one after the other: name and estimates, or why there are none."""
    for scheme in resolve_all(config.schemes, config):
        try:
            yield scheme.name, estimate(config, scheme, sensors, measured)
        except (Exception, SystemExit) as error:  # a user's scheme: the others have theirs
            yield scheme.name, " ".join(f"{type(error).__name__}: {error}".split())
