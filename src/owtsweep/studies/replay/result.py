"""The object that `owtsweep.replay` returns."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.errors import InputError
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.running import locate_estimates
from owtsweep.sweep.runs import Run

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Replay:
    """A finished replay."""

    run: Run

    @property
    def folder(self) -> Path:
        """The run folder."""
        return self.run.folder

    def errors(self) -> pd.DataFrame:
        """Means over replicates, 95 % intervals: file, scheme, measure, window, mean, ..., n."""
        return self.run.table("errors")

    def advice(self) -> pd.DataFrame:
        """The best scheme and the runner-up, by the record itself and by the expected map."""
        return self.run.table("advice")

    def records(self) -> pd.DataFrame:
        """One row per record: duration, size, direction and fitted spectrum."""
        return self.run.table("records")

    def estimates(self, record: str | None = None) -> pd.DataFrame:
        """Columns time, scheme, x, y, vx, vy and their standard deviations (replicate 0).

        Parameters
        ----------
        record
            The record's name, a value of `records().file`; needed if there are several.

        Raises
        ------
        InputError
            If there are several records and none is named, or none has that name.
        """
        import pandas as pd

        config = self.run.config
        if not isinstance(config, ReplayConfig):
            raise InputError(f"{self.run.folder}: this is no replay but a run of {config.study}")
        folders = locate_estimates(config, self.run.folder)
        if record is None and len(folders) == 1:
            record = next(iter(folders))
        if record not in folders:
            raise InputError(f"record: {record!r} is none of {', '.join(folders)}")
        return pd.read_parquet(folders[record] / "estimates.parquet")
