"""The files of the command `spectrum`, and what it prints."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from rich.console import RenderableType

from owtsweep.figures import style
from owtsweep.io.tables import write_table
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.figures import error_spectra, spectrum_tables


def write(
    config: HubConfig, folder: Path, metadata: Mapping[str, str]
) -> tuple[list[Path], RenderableType]:
    """Draw the schemes' error spectra, and write them and the noise floors as tables."""
    errors = error_spectra.compute(config)
    same = spectrum_tables.coinciding(errors)
    figure = error_spectra.draw(config, errors=errors, coinciding=same, motion=True)
    folder.mkdir(parents=True, exist_ok=True)
    files = style.save(figure, folder, "error_spectra", metadata)
    files.append(write_table(folder, "spectrum", spectrum_tables.curves(errors)))
    files.append(write_table(folder, "noise_floor", spectrum_tables.floors(errors)))
    return files, spectrum_tables.terminal(config, errors)
