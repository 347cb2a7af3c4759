"""Draws and tabulates the error spectra and noise floors, for the command `spectrum`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from rich.table import Table
from rich.text import Text

from owtsweep.figures.drawings import save_figure
from owtsweep.io.tables import write_table
from owtsweep.io.terminal import start_table
from owtsweep.statistics.contest import agree, group_coinciding
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.describe import describe_truth
from owtsweep.studies.hub.figures import error_spectra
from owtsweep.studies.hub.figures.error_spectra import UNITS, SchemeErrors
from owtsweep.studies.hub.noise_floor import SOURCES


def write(config: HubConfig, folder: Path, metadata: Mapping[str, str]) -> tuple[list[Path], Table]:
    """Write figures of the error spectra, and the tables spectrum and noise_floor, into a folder.

    Return the files, and a table of the noise floors for the terminal. Raises InputError if no
    scheme of the study has an error spectrum.
    """
    errors = error_spectra.compute(config)
    draw = partial(
        error_spectra.draw, config, errors=errors, coinciding=coinciding(errors), motion=True
    )
    files = save_figure(draw, metadata)(folder, "error_spectra")
    noise = floors(errors)
    files.append(write_table(folder, "spectrum", curves(errors)))
    files.append(write_table(folder, "noise_floor", noise))
    return files, terminal(config, noise)


def curves(errors: Mapping[str, SchemeErrors]) -> pd.DataFrame:
    """Make a table of the error spectra, one row per scheme and frequency.

    The columns are scheme, frequency (Hz), and position and velocity: mean square errors divided by
    the mean square of the displacement, in m^2/m^2 and in s^-2.
    """
    parts = [pd.DataFrame({"scheme": name, **vars(of.spectrum)}) for name, of in errors.items()]
    return pd.concat(parts, ignore_index=True)


def floors(errors: Mapping[str, SchemeErrors]) -> pd.DataFrame:
    """Make a table of the noise floors, one row per scheme, measure and source of noise.

    The columns are scheme, measure (position or velocity), source (gnss, imu, bias or all), and mse
    in m^2 or (m/s)^2; NaN if the scheme's error from noise does not settle.
    """
    rows = []
    for name, of_scheme in errors.items():
        for measure in UNITS:
            none = dict.fromkeys(SOURCES, np.nan)
            parts = none if of_scheme.floor is None else getattr(of_scheme.floor, measure)
            for source, value in {**parts, "all": sum(parts.values())}.items():
                rows.append((name, measure, source, value))
    return pd.DataFrame(rows, columns=["scheme", "measure", "source", "mse"])


def coinciding(errors: Mapping[str, SchemeErrors]) -> list[tuple[str, ...]]:
    """Find the groups of schemes whose error spectra are equal up to rounding."""
    spectra = [error.spectrum for error in errors.values()]

    def coincide(i: int, j: int) -> bool:
        return all(np.all(agree(spectra[i].of(m), spectra[j].of(m))) for m in UNITS)

    return group_coinciding(list(errors), coincide)


def terminal(config: HubConfig, noise: pd.DataFrame) -> Table:
    """Make a table for the terminal of what `floors` returns: root mean squares, cm and cm/s."""
    table = start_table(
        f"Settled error from noise alone, rms of x + y, tuning {config.tuning_name}\n"
        f"Truth: {describe_truth(config)}; no record is needed"
    )
    table.add_column("scheme")
    table.add_column("of")
    for source in (*SOURCES, "all"):
        table.add_column(source, justify="right")
    for key, rows in noise.groupby(["scheme", "measure"], sort=False):
        name, measure = map(str, key)
        cells = [*["-"] * len(SOURCES), "does not settle"]
        if rows["mse"].notna().all():
            unit = {"position": "cm", "velocity": "cm/s"}[measure]
            cells = [f"{100 * np.sqrt(value):.3g} {unit}" for value in rows["mse"]]
        table.add_row(Text(name), measure, *cells)  # as typed: it may hold rich's markup
    return table
