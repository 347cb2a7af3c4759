"""The command `spectrum`: draw the schemes' error spectra and noise floors, without a record."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from owtsweep.cli.program import DONE
from owtsweep.cli.running import require_serving
from owtsweep.io.files import check_writable, refuse_in_one_line
from owtsweep.io.reading import refuse_links
from owtsweep.sweep.keys import run_folder, run_hash
from owtsweep.sweep.study import blame


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Write figures and tables into the run's folder spectrum/, print the noise floors, return 0.

    With several tunings, each has a folder of its own: spectrum/<tuning>/.

    Raises InputError if the study has no error spectra, or the configuration is refused.
    """
    from owtsweep.studies import compose

    config = compose(options.overrides, options.config_dir)
    study = require_serving("spectrum", config.study)
    from rich.console import Console

    metadata = {"run": run_hash(config)}
    refuse_links(run_folder(config), but=("cases",))
    check_writable(run_folder(config) / "spectrum")
    for tuning, part in config.by_tuning().items():
        folder = run_folder(config) / "spectrum" / tuning
        with refuse_in_one_line(folder), blame(study):
            files, answer = study.write_spectrum(part, folder, metadata=metadata)
        Console().print(answer)
        print(f"{len(files)} files: {folder}/")
    return DONE
