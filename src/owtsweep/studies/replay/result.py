"""What `owtsweep.replay` returns."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.errors import InputError
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.running import folders
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
        """Means over the draws with 95 % intervals: file, scheme, measure, window, mean, ..., n."""
        return self.run.table("errors")

    def advice(self) -> pd.DataFrame:
        """The best scheme and the next, from the record itself and from the expected map."""
        return self.run.table("advice")

    def records(self) -> pd.DataFrame:
        """One line per record: duration, size, direction and fitted spectrum."""
        return self.run.table("records")

    def estimates(self, record: str | None = None) -> pd.DataFrame:
        """time, scheme, x, y, vx, vy and their standard deviations (replicate 0).

        Parameters
        ----------
        record
            The record's name, a value of `records().file`; needed if there are several.

        Raises
        ------
        InputError
            If it is needed or unknown.
        """
        import pandas as pd

        config = self.run.config
        if not isinstance(config, ReplayConfig):
            raise InputError(f"{self.run.folder}: this is no replay but a run of {config.study}")
        known = folders(config, self.run.folder)
        if record is None and len(known) == 1:
            record = next(iter(known))
        if record not in known:
            raise InputError(f"record: {record!r} is none of {', '.join(known)}")
        return pd.read_parquet(known[record] / "estimates.parquet")
