"""`tune`: search each scheme's best numbers for given sensors, and write them as a tuning file."""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from owtsweep.cli.program import DONE, INTERRUPTED
from owtsweep.cli.running import describe_cost, require_serving, show_answer, tell_dry_run
from owtsweep.config import Config, dump, get_key, require
from owtsweep.config.tuned import GROUP
from owtsweep.io.files import check_writable, refuse_in_one_line, write_atomically
from owtsweep.io.reading import expand_home
from owtsweep.sweep.keys import LONGEST_NAME, hash_text
from owtsweep.sweep.study import blame

#: The tuning that a search begins with, and that its result is compared with.
START = "matched"


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Search, write the tuning file, judge it on records and print what was gained.

    With `--dry-run`, print what would be searched, and return 0. Return 130 if the user stopped the
    search; the file then holds the best numbers so far.

    Raises InputError if the study has nothing to tune, or the configuration or the file is refused.
    """
    from owtsweep.studies import compose

    start = [] if GROUP in map(get_key, options.overrides) else [f"{GROUP}={START}"]
    config = compose([*start, *options.overrides], options.config_dir)
    require(
        "" in config.by_tuning(),
        f"{GROUP}: a search begins with one tuning; name one, e.g. {GROUP}={START}",
    )
    study = require_serving("tune", config.study)
    path = _choose_path(options.output, config)
    check_writable(path.parent, "--output", "name another file by --output FILE")
    with blame(study):
        trials = study.count_trials(config)
        if options.dry_run:
            cost = describe_cost(study.predict_tune(config))
            return tell_dry_run([f"file    {path}", f"trials  {trials}", *cost])
        with _progress(trials) as advance:
            tuned = study.tune(config, advance)
        name = re.sub(r"[^\w.+=-]", "_", path.stem)
        with refuse_in_one_line(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(path, tuned.text(name))
        if tuned.stopped:
            _tell(f"interrupted; {path} holds the best of the {tuned.trials} trials made")
            return INTERRUPTED
        try:
            answer = tuned.judge()
        except KeyboardInterrupt:
            _tell(f"interrupted; {path} is complete, but was not judged on records")
            return INTERRUPTED
    show_answer(answer)
    print(f"{path}: use it by {GROUP}={path if '/' in str(path) else f'./{path}'}")
    return DONE


def _tell(text: str) -> None:
    print(f"owtsweep: {text}", file=sys.stderr)


def _choose_path(output: str | None, config: Config) -> Path:
    """Return the path of the tuning file; its name is a hash of the configuration if none is given.

    Raises InputError if `tuning=FILE` could not take the path.
    """
    if output is None:
        return Path(f"tuned-{hash_text(dump(config))}.yaml")
    path = expand_home(output)
    require(
        path.suffix == ".yaml" and re.search(r"[,\[\]'\"]", output) is None,
        f"--output: {output!r} is no name of a tuning file; use one that ends in .yaml, without "
        "commas, brackets and quotes",
    )
    require(not os.path.isdir(path), f"--output: {output} is a folder; name a file")
    require(
        len(os.fsencode(path.name)) <= LONGEST_NAME,
        f"--output: the name has more than {LONGEST_NAME} bytes; use a shorter one",
    )
    return path


@contextmanager
def _progress(total: int) -> Iterator[Callable[[str], None]]:
    """Show a bar with the trials made, or, if stderr is no terminal, a line for each scheme."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.0f} of {task.total:.0f} trials"),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        disable=not sys.stderr.isatty(),
    )
    task = bar.add_task("tuning", total=total)
    seen: set[str] = set()

    def tell(scheme: str) -> None:
        bar.update(task, advance=1, description=f"tuning {scheme}")
        if bar.disable and scheme not in seen:
            print(f"tuning {scheme} ({total} trials for all schemes)", file=sys.stderr)
        seen.add(scheme)

    with bar:
        yield tell
