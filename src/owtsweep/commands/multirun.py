"""`sweep --multirun`: whole studies, one for each combination, through Hydra's own machinery."""

from __future__ import annotations

import argparse
import hashlib
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from owtsweep.cli import BAD_INPUT, DONE
from owtsweep.config import (
    Config,
    compose,
    conf_directory,
    dump,
    from_mapping,
    one_line,
    require,
)
from owtsweep.errors import InputError
from owtsweep.sweep.keys import run_folder


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
    _check_folders(configs, combinations)
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


def _check_folders(configs: Sequence[Config], combinations: Sequence[Sequence[str]]) -> None:
    """Refuse runs that would share a folder: the later would overwrite the earlier's tables."""
    require(
        len({config.results for config in configs}) <= 1,
        "results: one multirun has one results folder; give one value",
    )
    seen: dict[Path, Sequence[str]] = {}
    for config, overrides in zip(configs, combinations, strict=True):
        folder = run_folder(config)
        if folder in seen:
            ours, theirs = (" ".join(words) for words in (overrides, seen[folder]))
            raise InputError(
                f"--multirun: [{theirs}] and [{ours}] share the run folder {folder.name}; name, "
                "grid, schemes and compute do not tell runs apart, so sweep over other keys"
            )
        seen[folder] = overrides


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
        raise InputError(one_line(error)) from error
    return [list(job) for batch in batches for job in batch]


def _through_hydra(job: Any, options: argparse.Namespace, folder: Path) -> None:
    import hydra
    from hydra.errors import HydraException
    from omegaconf.errors import OmegaConfBaseException

    from owtsweep.sweep.files import check_writable

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
    sys.argv = [before[0], "--multirun", *extra, *own, *settings]
    check_writable(folder)
    full_error = os.environ.get("HYDRA_FULL_ERROR")
    os.environ["HYDRA_FULL_ERROR"] = "1"  # let errors reach us instead of ending in sys.exit
    try:
        hydra.main(version_base="1.3", config_path=str(conf_directory()), config_name="sweep")(
            job
        )()
    except (HydraException, OmegaConfBaseException) as error:
        raise InputError(one_line(error)) from error
    finally:
        sys.argv = before
        if full_error is None:
            del os.environ["HYDRA_FULL_ERROR"]
