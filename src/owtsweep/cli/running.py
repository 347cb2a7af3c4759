"""What the commands `sweep` and `replay` do before, after or in place of a run."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import floor, log10
from pathlib import Path
from typing import TYPE_CHECKING

from owtsweep.cli.program import DONE, FAILED, same_command
from owtsweep.config import Config
from owtsweep.errors import InputError, printable, require
from owtsweep.io.files import check_writable, refuse_in_one_line
from owtsweep.io.reading import refuse_links
from owtsweep.process import keep_freed_memory
from owtsweep.statistics.deciding import LOOKS
from owtsweep.sweep.asked import PAGE
from owtsweep.sweep.keys import hash_text, run_folder
from owtsweep.sweep.study import Study, blame

if TYPE_CHECKING:
    from rich.console import RenderableType

    from owtsweep.sweep.gather import Results
    from owtsweep.sweep.prepare import Forecast
    from owtsweep.sweep.rows import Setback
    from owtsweep.sweep.run import Outcome
    from owtsweep.sweep.runs import Run

#: Most reasons listed at the end of a sweep; run.log has all.
MOST_REASONS = 10
MOST_LABELS = 3
#: Most columns of an answer: the same text on a terminal, in a file and in a pipe.
WIDTH = 80


def require_serving(command: str, name: str) -> Study:
    """Return the study with a name; raise `InputError` if it does not have this command."""
    from owtsweep.studies import get_study
    from owtsweep.studies.registry import list_serving

    study = get_study(name)
    if command not in study.commands:
        serving = list_serving(command)
        raise InputError(
            f"study: `{command}` serves {serving} only, not {name!r}; use "
            f"study={serving.partition(',')[0]}"
        )
    return study


def name_folder(command: str, config: Config, query: str) -> Path:
    """Return the folder for the answer to a query, checked: named by the command and a hash."""
    require(
        config.name is None,
        f"name: `{command}` names its folder by the query; leave out name, or choose another place "
        "by results=FOLDER",
    )
    folder = Path(config.results) / f"{command}-{hash_text(query)}"
    refuse_links(folder)
    check_writable(folder)
    return folder


def may_start(options: argparse.Namespace, config: Config) -> bool:
    """Return whether a run may start; ask the user before `--fresh` deletes the run's cases.

    Without `--fresh`, with `--yes`, or if the run has no stored cases, return True and ask
    nothing. If the user says no, print that nothing was done, and return False.

    options: the parsed arguments of the command.
    config: the configuration of the run.
    Raises InputError if the user would have to be asked, but stdin is no terminal.
    """
    folder = run_folder(config)
    if not options.fresh or options.yes or not (folder / "cases").is_dir():
        return True
    if not sys.stdin.isatty():
        raise InputError(
            f"--fresh: this would delete the cases, tables and figures in {folder}; add --yes"
        )
    answer = input(f"Delete the cases, tables and figures in {folder} and start over? [y/N] ")
    if answer.strip().lower() in ("y", "yes"):
        return True
    print("owtsweep: nothing was deleted, nothing was run", file=sys.stderr)
    return False


def run_one(config: Config, argv: Sequence[str], *, fresh: bool = False) -> int:
    """Make one run, draw its overview figure, print its result, and return the exit code.

    The exit code is 1 if a case failed or the figure or the result could not be made, otherwise 0.

    config: the configuration of the run.
    argv: the words of the command line, which the run stores.
    fresh: whether to delete the run's stored cases first.
    """
    from owtsweep.studies import get_study
    from owtsweep.sweep.progress import make_progress
    from owtsweep.sweep.run import sweep

    keep_freed_memory()
    study = get_study(config.study)
    outcome = sweep(study, config, fresh=fresh, progress=make_progress(), argv=argv)
    run, results = outcome.run, outcome.results
    shown = True
    if results:
        draw = partial(run.draw, results=results, overview=True)
        shown &= write_or_tell("map could not be drawn", draw, run.place)
        write = partial(run.write_report, results=results)
        shown &= write_or_tell("page could not be written", write, run.place)
        shown &= print_answer(run, results)
        for line in tell_further(outcome):
            print(line)
    page = run.place / PAGE
    code = tell_end(outcome, argv, str(page) if page.is_file() else f"{run.place}/")
    return code if shown else FAILED


def write_or_tell(failure: str, write: Callable[[], object], folder: Path) -> bool:
    """Write what is made of results into a folder; return whether it could be written.

    If it could not, `failure` and the reason are printed to stderr. What is there is kept.
    """
    try:
        with refuse_in_one_line(folder):
            write()
    except InputError as error:
        print(f"failed: the {failure}: {error}", file=sys.stderr)
        return False
    return True


def print_answer(run: Run, results: Mapping[str, Results]) -> bool:
    """Print the run's result in a few lines; return True, or False if the study cannot make them.

    The results of several tunings stand side by side, as far as they fit. The reason of a failure
    is printed to stderr.

    results: the results by tuning.
    """
    from rich.columns import Columns

    try:
        with blame(run.study):
            parts = [run.engine.terminal(part.config, part.tables) for part in results.values()]
        show_answer(Columns(parts, padding=(0, 4)) if len(parts) > 1 else parts[0])
    except InputError as error:
        print(f"failed: the result could not be shown: {error}", file=sys.stderr)
        return False
    return True


def tell_further(outcome: Outcome) -> list[str]:
    """Return in a line what would decide the open cells: most records of a cell, and some time.

    The time is that of a case of this sweep, for each further record of each contender that is
    left. Return [] if no cell is open, or nothing was computed now.
    """
    from owtsweep.results.verdicts import SEPARATOR

    cases, most = 0.0, 0
    for part in outcome.results.values():
        best = part.tables.get("best_scheme")
        if best is None or "more" not in best or not len(best):
            continue
        still = best[(best["criterion"] == best["criterion"].iloc[0]) & (best["more"] > 0)]
        left = still["left"].str.count(SEPARATOR) + 1
        cases += float((still["more"] * left).sum())
        most = max(most, int((still["n"] + still["more"]).max()) if len(still) else 0)
    if not most or not outcome.computed:
        return []
    minutes = cases * outcome.seconds / outcome.computed / 60.0
    needed = next((look for look in LOOKS if look >= most), LOOKS[-1])
    return [
        f"Open cells: grid.most={needed}, some {_round(minutes)} minutes more, would decide them."
    ]


def show_answer(answer: RenderableType) -> None:
    """Print an answer in `WIDTH` columns, or in those of a narrower terminal."""
    from rich.console import Console

    wide = Console().width if sys.stdout.isatty() else WIDTH
    Console(width=min(wide, WIDTH)).print(answer)


def tell_end(outcome: Outcome, argv: Sequence[str], place: str) -> int:
    """Print how a run ended, and return the exit code: 1 if cases failed, else 0.

    First, cases that failed or that a scheme cannot compute are printed to stderr, with reasons.
    Then the number of computed cases is printed, with the text `place`, which says where the
    results are. `argv` are the words of the command line, to be repeated if cases failed.
    """
    for line in setback_lines("unable", outcome.unable) + setback_lines("failed", outcome.failed):
        print(line, file=sys.stderr)
    if outcome.failed:
        cases = sum(setback.cases for setback in outcome.failed)
        again = f"{_count(cases)} failed; " if cases else ""
        print(f"{again}the same command tries again:", file=sys.stderr)
        print(f"  {same_command(argv)}", file=sys.stderr)
    reused = f", {outcome.reused} were there" if outcome.reused else ""
    print(f"{outcome.computed} cases computed{reused} in {outcome.seconds:.1f} s: {place}")
    return FAILED if outcome.failed else DONE


def setback_lines(word: str, setbacks: Sequence[Setback]) -> list[str]:
    """Return lines about cases without a result: one line per reason, the commonest reason first.

    A line holds `word` (e.g. "failed"), the number of cases with this reason, the reason, and the
    labels of at most `MOST_LABELS` of their blocks. A block is a group of cases computed
    together. If there are more than `MOST_REASONS` reasons, a last line says how many are left
    out. A setback is a number of cases of one block that have no result for one reason.
    """
    by_reason: dict[str, list[Setback]] = {}
    for setback in setbacks:
        by_reason.setdefault(setback.reason, []).append(setback)
    groups = sorted(by_reason.items(), key=lambda item: (-sum(s.cases for s in item[1]), item[0]))
    lines = []
    for reason, group in groups[:MOST_REASONS]:
        labels = list(dict.fromkeys(setback.label for setback in group))
        more = f" and {len(labels) - MOST_LABELS} more" if len(labels) > MOST_LABELS else ""
        cases = sum(setback.cases for setback in group)
        count = f"{_count(cases)}: " if cases else ""
        lines.append(f"{word}: {count}{reason}: {'; '.join(labels[:MOST_LABELS])}{more}")
    if len(groups) > MOST_REASONS:
        lines.append(f"{word}: {len(groups) - MOST_REASONS} more reasons: see run.log")
    return lines


def _count(cases: int) -> str:
    return f"{cases} case" if cases == 1 else f"{cases} cases"


def foretell(configs: Sequence[Config], *, fresh: bool = False) -> int:
    """Print what runs of these configurations would do, and return 0; nothing is written.

    Raises InputError if one of the runs would refuse to start.
    """
    from owtsweep.studies import get_study
    from owtsweep.sweep.prepare import forecast

    forecasts = [forecast(get_study(config.study), config, fresh=fresh) for config in configs]
    lines = [line for each in forecasts for line in _describe(each)]
    if len(forecasts) > 1:
        cases = sum(each.cases for each in forecasts)
        missing = sum(each.missing for each in forecasts)
        runs = f"{len(forecasts)} runs, one after the other"
        lines.append(f"{runs}: {cases} cases, {missing} to compute")
    return tell_dry_run(lines)


def tell_dry_run(lines: Sequence[str]) -> int:
    """Print what a command would do, and return 0."""
    print("Nothing was computed or written. This command without --dry-run would do:")
    print("\n".join(lines))
    return DONE


def _describe(each: Forecast) -> list[str]:
    stored = each.cases - each.missing
    of = "in all" if each.most is None else f"for the first look (at most {each.most})"
    return [
        f"folder  {printable(str(each.folder))}/",
        f"cases   {each.cases} {of}, {stored} stored already, {each.missing} to compute",
        f"time    {_describe_time(each)}",
        _describe_memory(each.memory),
    ]


def _describe_time(each: Forecast) -> str:
    if each.missing == 0:
        return "none but for tables and figures"
    if each.seconds is None:
        timed = each.workers > 0
        why = "no sweep has timed these blocks" if timed else "it depends on the cluster's workers"
        return f"unknown: {why}"
    basis = "as long as blocks took before in this folder"
    if each.basis == "rough":
        basis = "rough, for cores without other work; compiling comes first if it has not been done"
    workers = f"{each.workers} worker{'s' * (each.workers != 1)}"
    return f"some {_round(each.seconds)} s on {workers} ({basis})"


def describe_cost(predicted: tuple[float, float] | None) -> list[str]:
    """Return lines on the predicted time (s) and memory (bytes) of a command; None: unknown."""
    seconds, memory = predicted or (None, None)
    time = "unknown: nobody has timed these schemes"
    if seconds is not None:
        time = f"some {_round(seconds)} s (rough, for cores without other work)"
    return [f"time    {time}", _describe_memory(memory)]


def _describe_memory(memory: float | None) -> str:
    told = "unknown" if memory is None else f"some {_round(memory / 1e9)} GB (rough)"
    return f"memory  {told}"


def _round(value: float) -> str:
    """Return a number with one or two digits that count, without an exponent."""
    if value < 0.1:
        return "0.1"
    digits = 0 if value >= 10 else 1
    unit = 10 ** max(floor(log10(value)) - 1, -digits)
    return f"{round(value / unit) * unit:.{digits}f}"
