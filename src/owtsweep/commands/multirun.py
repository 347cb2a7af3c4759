"""`sweep --multirun`: whole studies, one for each combination, through Hydra's own machinery."""

from __future__ import annotations

import argparse
import hashlib
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from owtsweep.cli import BAD_INPUT, DONE
from owtsweep.config import compose, conf_directory, dump, from_mapping
from owtsweep.errors import InputError


def run_all(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Check every combination first, then run them one after the other.

    Only this way of running goes through `hydra.main`, so that Hydra's sweepers and launchers
    work. All runs lie below one folder, whose name depends on the overrides alone: the same
    command finds it again.
    """
    if options.fresh:
        raise InputError("--fresh: this works on one run; name it without --multirun")
    combinations = _combinations(options.overrides)
    configs = [compose(overrides, options.config_dir) for overrides in combinations]
    if options.cfg:
        print("---\n".join(dump(config) for config in configs), end="")
        return DONE
    results = configs[0].results if configs else "results"
    digest = hashlib.blake2b("\n".join(sorted(options.overrides)).encode(), digest_size=5)
    folder = Path(results) / f"multirun-{digest.hexdigest()}"
    codes: list[int] = []

    def job(composed: Any) -> None:
        from owtsweep.commands.sweep import run_one

        try:
            codes.append(run_one(from_mapping(composed), argv))
        except InputError as error:
            print(f"owtsweep: {error}", file=sys.stderr)
            codes.append(BAD_INPUT)

    _through_hydra(job, options, folder)
    print(f"{len(combinations)} runs: {folder}/")
    return max(codes, default=DONE)


def _combinations(overrides: Sequence[str]) -> list[list[str]]:
    """What Hydra's basic sweeper will make of the overrides."""
    from hydra._internal.core_plugins.basic_sweeper import BasicSweeper
    from hydra.core.override_parser.overrides_parser import OverridesParser
    from hydra.errors import HydraException

    try:
        parsed = OverridesParser.create().parse_overrides(list(overrides))
        own = [o for o in parsed if not str(o.key_or_group).startswith("hydra")]
        batches = BasicSweeper.split_arguments(own, max_batch_size=None)
    except HydraException as error:
        raise InputError(" ".join(str(error).split())) from error
    return [list(job) for batch in batches for job in batch]


def _through_hydra(job: Any, options: argparse.Namespace, folder: Path) -> None:
    import hydra

    settings = [
        f"results={folder}",
        f"hydra.sweep.dir={folder}",
        "hydra.sweep.subdir=.",
        f"hydra.run.dir={folder}",
        "hydra.output_subdir=null",
        "hydra/job_logging=none",
        "hydra/hydra_logging=none",
    ]
    own = [o for o in options.overrides if not o.startswith("results=")]
    extra = ["--config-dir", options.config_dir] if options.config_dir else []
    before = sys.argv
    sys.argv = [before[0], "--multirun", *extra, *settings, *own]
    try:
        hydra.main(version_base="1.3", config_path=str(conf_directory()), config_name="sweep")(
            job
        )()
    finally:
        sys.argv = before
