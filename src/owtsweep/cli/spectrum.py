"""The command `spectrum`: draw the schemes' error spectra and noise floors, without a record."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from owtsweep.cli.program import DONE
from owtsweep.errors import InputError


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Write figures and tables of the schemes' error spectra, print noise floors, and return 0.

    The files are written into the subfolder spectrum/ of the run's folder. `options` are the
    parsed arguments of the command; `argv` is not used.

    Raises
    ------
    InputError
        If the study has no error spectra, the configuration is refused, or a file cannot be
        written.
    """
    from owtsweep.io.files import check_writable, refuse_in_one_line
    from owtsweep.studies import compose, get_study
    from owtsweep.sweep.keys import run_folder, run_hash
    from owtsweep.sweep.study import Spectral, blame

    config = compose(options.overrides, options.config_dir)
    study = get_study(config.study)
    if not isinstance(study, Spectral):
        raise InputError(f"study: {config.study!r} has no error spectra; use another study")
    folder = run_folder(config) / "spectrum"
    check_writable(folder)
    with refuse_in_one_line(folder), blame(study):
        files, answer = study.write_spectrum(config, folder, metadata={"run": run_hash(config)})

    from rich.console import Console

    Console().print(answer)
    print(f"{len(files)} files: {folder}/")
    return DONE
