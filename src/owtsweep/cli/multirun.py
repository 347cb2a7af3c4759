"""The command `sweep --multirun`: make one run for each combination of overrides, with Hydra."""

from __future__ import annotations

import argparse
import contextlib
import logging
import os
import re
import shlex
import shutil
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from owtsweep.cli.combinations import Combination, combine, count_runs, parse
from owtsweep.cli.program import BAD_INPUT, DONE, FAILED, program_here, raise_interrupt
from owtsweep.cli.running import foretell, run_one, write_or_tell
from owtsweep.config import Config, Tree, changed, dump_with_units
from owtsweep.config.composition import compose_hydra, quoted, require_readable
from owtsweep.config.hints import hydra_in_one_line
from owtsweep.config.option_files import names_file
from owtsweep.config.tuned import GROUP
from owtsweep.errors import InputError, as_text, printable, require
from owtsweep.io.files import check_writable, refuse_in_one_line
from owtsweep.io.reading import refuse_links
from owtsweep.studies import compose, locate
from owtsweep.studies.registry import Located
from owtsweep.sweep.asked import PAGE
from owtsweep.sweep.keys import hash_text, run_folder
from owtsweep.sweep.manifest import read_manifest
from owtsweep.sweep.multirun import (
    OUTCOMES,
    JobOutcome,
    PlannedRun,
    read_outcome,
    write_outcome,
    write_page,
    write_record,
)
from owtsweep.sweep.worker import end_with_parent

logger = logging.getLogger(__name__)

NOT_FINISHED = "not finished"
NO_OUTCOME = "its process ended without a word, or the disk is full; see its run.log"
#: Most runs of a multirun: the configurations of all are made and checked before the first run.
MOST_RUNS = 10_000


def run_all(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Check all combinations of overrides, make a run for each, and return the exit code.

    If a run fails, the others are still made. The exit code is the largest exit code of a run.
    The runs are made through `hydra.main`, so that Hydra's sweepers and launchers work. All run
    folders lie in one folder, the multirun folder. Its name depends only on the overrides, so a
    repeated command finds the folder again.

    options: the parsed arguments of the command `sweep`. With `options.cfg`, the configurations are
        printed, and nothing is run.
    argv: the words of the command line, which each run stores.
    Raises InputError if `--fresh` is given, an override is refused, two runs would share a folder,
        or the multirun folder cannot be written.
    """
    if options.fresh:
        raise InputError("--fresh: this does not work with --multirun; leave out one of the two")
    _refuse_tuning_files(options.overrides)
    located = locate(options.overrides)
    combinations = _combinations(options.overrides, located.tree)
    configs = [compose(words, options.config_dir) for words, _ in combinations]
    _check_folders(configs, [words for words, _ in combinations])
    if options.cfg:
        print("---\n".join(dump_with_units(config) for config in configs), end="")
        return DONE
    given = [o.partition("=")[2] for o in options.overrides if _is_results(o)]
    results = configs[0].results if configs else ["results", *given][-1]
    query = hash_text("\n".join(sorted(options.overrides)))
    folder = Path(results) / f"multirun-{query}"
    if options.dry_run:
        require(
            bool(configs), "--dry-run: this works with Hydra's basic sweeper only; leave it out"
        )
        return foretell([changed(config, results=str(folder)) for config in configs])
    planned = [
        PlannedRun(run_folder(config).name, values, [o for o in words if not _is_results(o)])
        for config, (words, values) in zip(configs, combinations, strict=True)
    ]
    refuse_links(folder, deep=False)
    check_writable(folder)
    settings = [o for o in options.overrides if o.lstrip("+~").startswith("hydra")]
    if settings:  # refuses launchers and sweepers that are not installed
        compose_hydra(located.tree, settings, settings=True)
    shutil.rmtree(folder / OUTCOMES, ignore_errors=True)  # outcomes of an earlier multirun
    with refuse_in_one_line(folder):
        (folder / OUTCOMES).mkdir(parents=True)
        write_record(folder, options.overrides, planned)
    began = time.monotonic()
    try:
        job = Job(str(folder), tuple(argv), located.study, options.config_dir, os.getpid())
        _through_hydra(job, options, folder, located)
    except KeyboardInterrupt:
        _tell(folder, planned, options, stopped=True)
        raise
    outcomes = _tell(folder, planned, options, stopped=False)
    write = partial(write_page, folder, planned, outcomes)
    written = write_or_tell("page could not be written", write, folder)
    print(f"{len(outcomes)} runs in {time.monotonic() - began:.1f} s: {folder}/")
    if written:
        print(f"page to send, with those of the runs: {printable(str(folder / PAGE))}")
    codes = [DONE if written else FAILED, *(outcome.code for outcome in outcomes)]
    return max(codes)  # a refused run counts most


@dataclass(frozen=True)
class Job:
    """The task that Hydra calls once for each run of a multirun.

    A call makes one run and writes the outcome of this run to a file in the multirun folder. An
    error in the run is stored in that file, not raised, because a raised error would stop the
    launcher's other runs. Only an interrupt is raised. The task is a plain object, not a closure,
    so that launchers can pickle it.

    folder: the multirun folder, in which all run folders lie.
    argv: the words of the command line.
    study: the study that the overrides name; None if they name none.
    config_dir: the folder with further config groups; None if the user names none.
    coordinator: the id of the process that started the multirun.
    """

    folder: str
    argv: tuple[str, ...]
    study: str | None
    config_dir: str | None
    coordinator: int

    def __call__(self, composed: object) -> None:
        from hydra.core.hydra_config import HydraConfig

        if os.getppid() == self.coordinator:  # a process of the joblib launcher
            end_with_parent(self.coordinator)
        task = [str(o) for o in HydraConfig.get().overrides.task if not _is_results(str(o))]
        if self.study:
            task.insert(0, f"study={self.study}")
        name = "refused-" + hash_text("\n".join(task))
        try:
            # composed again: Hydra would lay several tunings on top of each other
            config = compose([*task, f"results={quoted(self.folder)}"], self.config_dir)
            name = run_folder(config).name
            code = run_one(config, self.argv)
            reason = _describe_failures(run_folder(config)) if code else ""
        except Exception as error:  # after any error the other runs go on
            raise_interrupt(error)
            refused = isinstance(error, InputError)
            code, reason = (BAD_INPUT, str(error)) if refused else (FAILED, as_text(error))
            logger.debug("run %s", name, exc_info=True)
        with contextlib.suppress(OSError):  # a full disk; `_tell` says that the outcome is missing
            write_outcome(Path(self.folder), JobOutcome(name, task, code, reason))


def _describe_failures(run_folder: Path) -> str:
    """Return a text with the number of failed cases in a run's manifest, e.g. "3 cases failed".

    If the manifest does not hold this number, return "some cases failed".
    """
    try:
        failed = int(read_manifest(run_folder)["cases"]["failed"])
    except (ValueError, KeyError, TypeError):
        return "some cases failed"
    return f"{failed} case{'s' * (failed != 1)} failed"


def _tell(
    folder: Path, planned: Sequence[PlannedRun], options: argparse.Namespace, *, stopped: bool
) -> list[JobOutcome]:
    """Print to stderr which runs failed, why, and how to retry each; return all outcomes.

    folder: the multirun folder, from which the outcomes are read.
    planned: the runs of the multirun. A planned run without a stored outcome counts as failed.
    options: the parsed arguments of the command.
    stopped: whether the user has stopped the multirun. If so, also print how many runs are done.
    """
    silent = NOT_FINISHED if stopped else NO_OUTCOME
    by_run = {run.folder: JobOutcome(run.folder, run.overrides, FAILED, silent) for run in planned}
    # `planned` is empty for other sweepers than Hydra's basic one; their runs are found here.
    for file in sorted((folder / OUTCOMES).glob("*.json")):
        outcome = read_outcome(file)
        by_run[outcome.folder] = outcome
    outcomes = list(by_run.values())
    bad = [outcome for outcome in outcomes if outcome.code]
    if stopped:
        print(f"{len(outcomes) - len(bad)} of {len(outcomes)} runs done: {folder}/")
    for outcome in bad:
        if outcome.reason == NOT_FINISHED:  # repeating the multirun's command continues it
            print(f"{NOT_FINISHED}: {outcome.folder}", file=sys.stderr)
            continue
        extra = ["--config-dir", options.config_dir] if options.config_dir else []
        plain = re.fullmatch(r"[\w./~-]+", str(folder)) is not None
        results = f"results={folder if plain else quoted(str(folder))}"
        command = shlex.join(["sweep", *extra, *outcome.overrides, results])
        print(f"failed: {outcome.folder}: {outcome.reason}", file=sys.stderr)
        print(f"  retry: {program_here()} {command}", file=sys.stderr)
    if bad and not stopped:
        print(f"{len(bad)} of {len(outcomes)} runs failed", file=sys.stderr)
    return outcomes


def _refuse_tuning_files(overrides: Sequence[str]) -> None:
    """Raise `InputError` for `tuning=FILE`: Hydra's sweepers take options of a group only."""
    for override in overrides:
        key, _, value = override.lstrip("+").partition("=")
        require(
            key != GROUP or not any(names_file(word.strip("[] '\"")) for word in value.split(",")),
            f"{override}: --multirun takes no tuning files; put them into DIR/tuning/, and name "
            "them by --config-dir DIR tuning=NAME",
        )


def _is_results(override: str) -> bool:
    return override.lstrip("+").partition("=")[0] == "results"


def _check_folders(configs: Sequence[Config], combinations: Sequence[Sequence[str]]) -> None:
    """Check that the runs of a multirun have one results folder but different run folders.

    Two runs in one run folder would overwrite each other's tables.

    configs: the configuration of each run.
    combinations: the overrides of each run, for the error message.
    Raises InputError if two runs would share a run folder, or the runs name different results
        folders.
    """
    require(
        len({config.results for config in configs}) <= 1,
        "results: the runs of a multirun have one results folder; give one value",
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


def _combinations(overrides: Sequence[str], tree: Tree) -> list[Combination]:
    """Return the overrides and the values of the swept keys of each run.

    The list is empty if the overrides choose another sweeper than Hydra's basic one, because the
    combinations of other sweepers are not known in advance.

    Raises InputError if an override cannot be read, or there are more than `MOST_RUNS`
        combinations.
    """
    require_readable(overrides)
    if any(o.startswith("hydra/sweeper=") and o != "hydra/sweeper=basic" for o in overrides):
        return []
    parsed = parse(overrides, tree)
    number = count_runs(parsed)
    require(
        number <= MOST_RUNS,
        f"--multirun: the overrides ask for {number:.6g} runs, and a multirun has at most "
        f"{MOST_RUNS}; give fewer values",
    )
    return combine(parsed, tree)


def _through_hydra(job: Job, options: argparse.Namespace, folder: Path, located: Located) -> None:
    import hydra

    settings = [
        f"++results={quoted(str(folder))}",
        f"hydra.sweep.dir={quoted(str(folder))}",
        "hydra.sweep.subdir=.",
        f"hydra.run.dir={quoted(str(folder))}",
        "hydra.output_subdir=null",
        "hydra/job_logging=none",
        "hydra/hydra_logging=none",
    ]
    overrides = [o for o in located.overrides if not _is_results(o)]
    tree = located.tree
    extra = ["--config-dir", options.config_dir] if options.config_dir else []
    before = sys.argv
    sys.argv = [before[0], "--multirun", *extra, *overrides, *settings]
    full_error = os.environ.get("HYDRA_FULL_ERROR")
    os.environ["HYDRA_FULL_ERROR"] = "1"  # raise errors here instead of calling sys.exit
    try:
        main = hydra.main(str(tree.folder), tree.primary, version_base="1.3")
        with hydra_in_one_line(tree):
            main(job)()
    finally:
        # Hydra's copy of its settings names the working folder; multirun.json has what matters.
        (folder / "multirun.yaml").unlink(missing_ok=True)
        sys.argv = before
        if full_error is None:
            del os.environ["HYDRA_FULL_ERROR"]
