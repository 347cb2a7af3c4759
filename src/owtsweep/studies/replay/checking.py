"""Read every record of a replay once, before anything is written, and tell which can be used."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from owtsweep.errors import InputError, printable
from owtsweep.studies.hub.public import resolve_all
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.identification.of_record import estimate_noise
from owtsweep.studies.replay.loading import load_record
from owtsweep.studies.replay.place import check_band
from owtsweep.studies.replay.seastates import read_sea_states


@dataclass(frozen=True)
class Verified:
    """What reading every record once has shown.

    notes: Sentences on the records, for the user; equal sentences appear once. If there are several
        records, each sentence begins with the name of the record's file.
    refused: Path of a file that cannot be used -> the reason, one line that begins with the path.
    """

    notes: Sequence[str]
    refused: Mapping[str, str]

    def lines(self) -> list[str]:
        """Return all notes, and the reasons why files are left out, as lines for the user."""
        return [
            *(f"note: {note}" for note in self.notes),
            *(f"left out: {reason}" for reason in self.refused.values()),
        ]


def verify(config: ReplayConfig) -> Verified:
    """Read every record once; tell which records cannot be used.

    Raise `InputError` if no record can be used, or if the table of sea states cannot (the one-line
    message names the file), or if no expected errors can be computed in the band `replay.band`.
    """
    read_sea_states(config)
    files, schemes = config.grid.files, resolve_all(config.schemes)
    notes: dict[str, None] = {}
    refused: dict[str, str] = {}
    for file in files:
        name = f"{printable(Path(file).name)}: " if len(files) > 1 else ""
        try:
            record = load_record(config, file)
            notes |= {f"{name}{note}": None for note in record.notes}
            if record.lean and len(files) > 1:  # of a single record it stands beside the advice
                notes[f"{name}{record.lean}"] = None
            for scheme in schemes:
                if record.steps * record.step < scheme.least_duration:
                    notes[
                        f"{name}{scheme.name} had no time to choose a spectrum, which takes "
                        f"{scheme.least_duration:g} s"
                    ] = None
            if config.replay.noise == "estimate" and (
                said := estimate_noise(config, file).disagreement
            ):
                notes[f"{name}{said}"] = None
        except InputError as error:
            refused[file] = str(error)
    if len(refused) == len(files):
        first = next(iter(refused.values()))
        none = f"none of the {len(files)} records can be used; the first: "
        raise InputError(first if len(files) == 1 else none + first)
    check_band(config)  # last: what a record says of the band is plainer
    return Verified(list(notes), refused)
