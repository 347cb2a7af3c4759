"""The command `replay`: run all schemes on recorded motion or on recorded sensor signals."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from owtsweep.cli.program import BAD_INPUT, DONE, FAILED, program_here
from owtsweep.cli.running import foretell, may_start, print_answer, tell_end, write_or_tell
from owtsweep.config import dump_with_units, require


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Replay record files, or only describe their channels, and return the exit code.

    A replay runs all schemes on the records, and writes tables, estimates, figures and a report.

    options: the parsed arguments of the command. `options.words` are the files and the overrides.
        With `options.describe` the files are described; with `options.cfg` the configuration is
        printed; with `options.sample` the sample records are written. Then nothing is run.
    argv: the words of the command line.
    Raises InputError if a file or an override is refused.
    """
    files = [word for word in options.words if "=" not in word]
    overrides = [word for word in options.words if "=" in word]
    if options.sample:
        return _write_sample(options.words)
    if options.describe:
        return _describe(files, overrides, options.config_dir)
    from owtsweep.studies.replay.running import compose_replay, configure, execute, verify
    from owtsweep.sweep.progress import make_progress

    if options.cfg and not files:  # printing the keys needs no record
        print(dump_with_units(compose_replay(overrides, options.config_dir)), end="")
        return DONE
    config = configure(files, overrides, options.config_dir)
    if options.cfg:
        print(dump_with_units(config), end="")
        return DONE
    if options.dry_run:
        refused = list(verify(config).refused.values())
        for reason in refused:
            print(f"left out: {reason}", file=sys.stderr)
        code = foretell([config], fresh=options.fresh)
        return FAILED if refused else code
    if not may_start(options, config):
        return BAD_INPUT
    outcome = execute(
        config, fresh=options.fresh, progress=make_progress(), argv=argv,
        say=lambda text: print(text, file=sys.stderr, flush=True),
    )  # fmt: skip
    from owtsweep.studies.replay import report
    from owtsweep.studies.replay.describe import list_fit_warnings

    for warning in list_fit_warnings(config) if len(config.grid.files) == 1 else ():
        print(f"note: spectrum: {warning}", file=sys.stderr)
    replayed, results = outcome.run, outcome.results

    def write() -> None:
        figures = replayed.draw(results=results)
        report.write(config, results[""].tables, figures, replayed.place)
        replayed.write_report(results=results)

    written = not results or write_or_tell("report could not be written", write, replayed.place)
    code = tell_end(outcome, argv, f"{replayed.place}/report.md")
    written &= not results or print_answer(replayed, results)
    return code if written else FAILED


def _describe(files: Sequence[str], overrides: Sequence[str], config_dir: str | None) -> int:
    from owtsweep.motion.recorded import describe
    from owtsweep.studies.replay.running import compose_replay, expand

    require(len(files) > 0, "FILE: name the file to describe")
    config = compose_replay(overrides, config_dir)
    print("\n\n".join(describe(file, **config.reading()) for file in expand(files)))
    return DONE


def _write_sample(words: Sequence[str]) -> int:
    from owtsweep.studies.replay.files import MOTION, SENSORS, TABLE, write_sample

    require(
        not words, "--sample: this writes the package's own records; leave out FILE and overrides"
    )
    write_sample(Path())
    print(f"{MOTION}: the motion of a hub, 60 s at 20 Hz; GNSS and IMU will be simulated")
    print(f"{SENSORS}: a recorded IMU (100 Hz) and GNSS (1 Hz, 0.2 s late), with the true position")
    print(f"{TABLE}: a table of both, for replay.table")
    program = program_here()
    print(f"next: {program} replay {MOTION}")
    print(f"      {program} replay {SENSORS}")
    return DONE
