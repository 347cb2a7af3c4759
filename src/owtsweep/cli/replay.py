"""`replay`: recorded motion or sensors through all schemes."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from owtsweep.cli import BAD_INPUT, DONE, FAILED, same_command
from owtsweep.config import dump, require


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Describe files, or replay them and write tables, estimates, figures and a report."""
    files = [word for word in options.words if "=" not in word]
    overrides = [word for word in options.words if "=" in word]
    if options.describe:
        return _describe(files, overrides, options.config_dir)
    from owtsweep.cli.sweep import confirmed
    from owtsweep.studies.replay.running import compose_replay, configure, execute
    from owtsweep.sweep.progress import make_progress

    if options.cfg and not files:  # a look at the keys needs no record
        print(dump(compose_replay(overrides, options.config_dir)), end="")
        return DONE
    config = configure(files, overrides, options.config_dir)
    if options.cfg:
        print(dump(config), end="")
        return DONE
    if options.fresh and not options.yes and not confirmed(config):
        print("owtsweep: nothing was deleted, nothing was run", file=sys.stderr)
        return BAD_INPUT
    progress = make_progress(quiet=False)
    outcome = execute(
        config, fresh=options.fresh, progress=progress, argv=list(argv),
        say=lambda text: print(text, file=sys.stderr, flush=True),
    )  # fmt: skip
    from owtsweep.studies.replay import report
    from owtsweep.studies.replay.terminal import list_spectrum_notes

    for note in list_spectrum_notes(config):
        print(f"note: {note}", file=sys.stderr)
    tables = outcome.run.tables()
    if tables:
        report.write(config, tables, outcome.run.draw(), outcome.run.folder)
        from rich.console import Console

        Console(width=None if sys.stdout.isatty() else 120).print(
            outcome.run.study.terminal(config, tables)
        )
    for failure in outcome.failed:
        print(f"failed: {failure.label}: {failure.reason}", file=sys.stderr)
    if outcome.failed:
        print(f"the same command tries again:\n  {same_command(argv)}", file=sys.stderr)
    reused = f", {outcome.reused} were there" if outcome.reused else ""
    print(
        f"{outcome.computed} cases computed{reused} in {outcome.seconds:.1f} s: "
        f"{outcome.run.folder}/report.md"
    )
    return FAILED if outcome.failed else DONE


def _describe(files: Sequence[str], overrides: Sequence[str], config_dir: str | None) -> int:
    from owtsweep.motion.recorded import describe
    from owtsweep.studies.replay.running import compose_replay, expand

    require(len(files) > 0, "FILE: name the file to describe")
    columns: dict[str, str] = {}
    units: dict[str, str] = {}
    if overrides:
        config = compose_replay(overrides, config_dir)
        columns, units = config.columns.given(), config.units.given()
    found = [describe(file, columns=columns, units=units) for file in expand(files)]
    print("\n\n".join(map(str, found)))
    return DONE
