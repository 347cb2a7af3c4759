"""`spectrum`: draw the schemes' error spectra and noise floors, without any record."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from owtsweep.cli import DONE
from owtsweep.errors import InputError
from owtsweep.studies import compose

STUDY = "hub"


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Write error_spectra.png and .svg, spectrum.csv and noise_floor.csv; print the floors."""
    from owtsweep.io.files import check_writable
    from owtsweep.studies.hub.config import HubConfig
    from owtsweep.sweep.keys import run_folder

    config = compose(options.overrides, options.config_dir)
    if config.study != STUDY or not isinstance(config, HubConfig):
        raise InputError(f"study: {config.study!r} has no error spectra; use study={STUDY}")
    folder: Path = run_folder(config) / "spectrum"
    check_writable(folder)

    from rich.console import Console

    from owtsweep.figures import style
    from owtsweep.io.tables import write_table
    from owtsweep.studies.hub.figures import error_spectra, spectrum_tables
    from owtsweep.sweep.keys import run_hash

    errors = error_spectra.compute(config)
    same = spectrum_tables.coinciding(errors)
    figure = error_spectra.draw(config, errors=errors, coinciding=same, motion=True)
    folder.mkdir(parents=True, exist_ok=True)
    files = style.save(figure, folder, "error_spectra", {"run": run_hash(config)})
    files.append(write_table(folder, "spectrum", spectrum_tables.curves(errors)))
    files.append(write_table(folder, "noise_floor", spectrum_tables.floors(errors)))
    Console().print(spectrum_tables.terminal(config, errors))
    print(f"{len(files)} files: {folder}/")
    return DONE
