"""Parse the command line and run the subcommand that it names.

Only the module of this subcommand is imported. Exit codes: 0 done, 1 some cases failed, 2 bad
input, 130 interrupted.
"""

from __future__ import annotations

import argparse
import errno
import logging
import os
import shlex
import shutil
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from difflib import get_close_matches
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import NoReturn

from owtsweep._version import __version__
from owtsweep.cli.completing import complete_override
from owtsweep.errors import InputError, as_text, require, shorten
from owtsweep.io.search_path import no_modules_of_this_folder
from owtsweep.sweep.log import Lines

DONE, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130

#: The name in usage lines and examples; `program_here` returns what works in the user's shell.
PROGRAM = "owtsweep"

DESCRIPTION = """\
Sweeps conditions x estimation schemes for offshore wind installation, and maps which scheme is
best where. Studies: the hub's motion after Ren et al. (2019); with study=NAME also a tower, a
floater, a hoisted blade, its mating with the hub (`owtsweep list` has them)."""


class Parser(argparse.ArgumentParser):
    """An argument parser that raises `InputError` with one line, instead of exiting.

    commands: Name of a subcommand -> its parser. Only the parser of the whole command line has this
        attribute.
    """

    commands: Mapping[str, Parser]

    def error(self, message: str) -> NoReturn:
        """Raise `InputError` with the message of argparse, and what the user may have meant."""
        flags = [flag for action in self._actions for flag in action.option_strings]
        _, unknown, words = message.partition("unrecognized arguments: ")
        near = get_close_matches(words.split()[0], flags, n=1) if unknown else []
        hint = f"did you mean {near[0]}? " if near else ""
        raise InputError(f"{message}; {hint}see `{self.prog} --help`")


def _add_sweep(parser: Parser) -> None:
    _add_overrides(parser, "grid.replicates=2 (`--help study=NAME` shows a study's keys)")
    _add_flag(parser, "-m", "--multirun", help="one run for each value of a=1,2,3")
    _add_run_options(parser)


def _add_advise(parser: Parser) -> None:
    _add_overrides(parser, "natural_period=3.2")
    _add_flag(parser, "--quick", help="the answer alone, without levers and other worlds")
    _add_flag(parser, "--json", help="print one JSON object instead of sentences")
    _add_config_dir(parser)


def _add_replay(parser: Parser) -> None:
    parser.add_argument(
        "words", nargs="*", metavar="FILE|override", help="records or patterns; key=value words"
    )
    _add_flag(parser, "--describe", help="list channels, units, rates and gaps, and stop")
    _add_flag(parser, "--sample", help="write two sample records into this folder, and stop")
    _add_run_options(parser)


def _add_spectrum(parser: Parser) -> None:
    _add_overrides(parser, "tuning=matched")
    _add_config_dir(parser)


def _add_tune(parser: Parser) -> None:
    _add_overrides(parser, "sensors.gnss.rate=5")
    _add_flag(parser, "--dry-run", help="say what would be searched, in what time, and stop")
    _add_config_dir(parser)
    parser.add_argument(
        "--output", metavar="FILE", help="the tuning file to write; default tuned-<hash>.yaml"
    )


def _add_vary(parser: Parser) -> None:
    _add_overrides(parser, "sensors.gnss.rate=1,2,5,10")
    _add_flag(parser, "--cfg", help="print the configuration of each value with units and stop")
    _add_flag(parser, "--dry-run", help="say what would be computed, in what time, and stop")
    _add_config_dir(parser)


def _add_place(parser: Parser) -> None:
    _add_overrides(parser, "structure=./my_tower.yaml")
    parser.add_argument(
        "--quantity", metavar="NAME", help="whose error counts: stress (default) or base_moment"
    )
    parser.add_argument("--count", metavar="N", type=int, help="most sensors to choose; default 8")
    text = "to choose from, in m above the ground, e.g. 10,25,40; default: all ends of elements"
    parser.add_argument("--heights", metavar="LIST", help=text)
    _add_config_dir(parser)


def _add_init(parser: Parser) -> None:
    parser.add_argument("kind", choices=("scheme", "structure", "study"), help="what to write")
    parser.add_argument("name", metavar="NAME", help="its name, e.g. my_filter")
    text = "of a scheme: study=hub (default), tower, floater or blade"
    words = parser.add_argument("overrides", nargs="*", default=[], metavar="study=...", help=text)
    words.completer = complete_override  # type: ignore[attr-defined]


def _add_run(parser: Parser) -> None:
    parser.add_argument(
        "run", metavar="RUN", help="folder of a run, e.g. results/default-0a1b2c3d4e"
    )


def _add_fidelity(parser: Parser) -> None:
    _add_run(parser)
    text = "a file of claims (TOML) instead of those of the study's paper"
    parser.add_argument("--claims", metavar="FILE", help=text)


def _add_figures(parser: Parser) -> None:
    _add_run(parser)
    text = "only the map, with where a structure is on it: a name in conf/structure or a YAML file"
    parser.add_argument("--envelope", metavar="STRUCTURE", help=text)


def _add_report(parser: Parser) -> None:
    _add_run(parser)
    text = "the file to write; default: report.html in the run's folder"
    parser.add_argument("--output", metavar="FILE", help=text)
    text = "run record 0 of each cell once more, and show 40 s of truth and estimates"
    _add_flag(parser, "--details", help=text)


def _add_list(parser: Parser) -> None:
    text = (
        "a study, a config group, or a scheme, e.g. tower, sensors or HME1; default: all; "
        "with study=STUDY, of this study alone"
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=text)


def _add_runs(parser: Parser) -> None:
    text = "the folder that holds the runs; default: results"
    parser.add_argument("folder", nargs="?", default="results", metavar="FOLDER", help=text)


def _add_compare(parser: Parser) -> None:
    parser.add_argument(
        "runs", nargs="+", metavar="RUN", help="folder of a multirun, or folders of several runs"
    )


def _add_overrides(parser: Parser, example: str) -> None:
    text = f"Hydra override, e.g. {example}"
    words = parser.add_argument("overrides", nargs="*", metavar="override", help=text)
    words.completer = complete_override  # type: ignore[attr-defined]


def _add_run_options(parser: Parser) -> None:
    _add_flag(parser, "--cfg", help="print the resolved configuration with units and stop")
    _add_flag(parser, "--dry-run", help="say what would be computed, in what time, and stop")
    _add_config_dir(parser)
    _add_flag(parser, "--fresh", help="delete this run's cases, tables and figures, and start over")
    _add_flag(parser, "--yes", help="do not ask before deleting")


def _add_config_dir(parser: Parser) -> None:
    parser.add_argument("--config-dir", metavar="DIR", help="folder with more config groups")


def _add_flag(parser: Parser, *names: str, help: str) -> None:
    parser.add_argument(*names, action="store_true", help=help)


#: Name of a subcommand -> what it does, an example, and the function that adds its arguments to a
#: parser. The module of a subcommand is owtsweep.cli.<name>.
COMMANDS = {
    "advise": (
        "Say which estimator to run in one case, how good it is, and what would change that.",
        "advise natural_period=3.2 amplitude=0.5 sensors.gnss.rate=10",
        _add_advise,
    ),
    "sweep": (
        "Run a study, or finish one that was stopped, and draw its map.",
        "sweep grid.replicates=2 schemes=[MKF,HME1] tuning=matched",
        _add_sweep,
    ),
    "replay": (
        "Run the schemes on recorded motion or recorded sensors; say which one to run.",
        "replay towertop.outb columns.position_x=TwHt1TPxi",
        _add_replay,
    ),
    "figures": (
        "Draw all figures and tables of a run into its folder figures/.",
        "figures results/default-0a1b2c3d4e",
        _add_figures,
    ),
    "report": (
        "Write report.html, one page of a run to send: it opens offline, in any browser.",
        "report results/default-0a1b2c3d4e",
        _add_report,
    ),
    "fidelity": (
        "Judge the claims of a study's paper, or yours, by a run; writes RUN/fidelity/.",
        "fidelity results/default-0a1b2c3d4e",
        _add_fidelity,
    ),
    "compare": (
        "Compare the runs of a multirun, or some runs: how the map moves with what was changed.",
        "compare results/multirun-0a1b2c3d4e",
        _add_compare,
    ),
    "spectrum": (
        "Draw the schemes' error spectra and noise floors, without any record (study=hub).",
        "spectrum tuning=matched sensors.gnss.delay=0.4",
        _add_spectrum,
    ),
    "tune": (
        "Search the schemes' best numbers for these sensors; writes a tuning=FILE.",
        "tune sensors.gnss.rate=5 --output mine.yaml",
        _add_tune,
    ),
    "vary": (
        "Draw each scheme's error over the values of one key, e.g. a GNSS rate.",
        "vary sensors.gnss.rate=1,2,5,10 grid.natural_period=[4]",
        _add_vary,
    ),
    "place": (
        "Say how many inclinometers are enough, and where, before any is mounted (study=tower).",
        "place study=tower structure=./my_tower.yaml grid.noise=[3]",
        _add_place,
    ),
    "show": (
        "Tell what a run is: versions, seed, command line, times, cases, failures.",
        "show results/default-0a1b2c3d4e",
        _add_run,
    ),
    "init": (
        "Write a first scheme, structure or study of your own, to be changed by you.",
        "init scheme my_filter study=floater",
        _add_init,
    ),
    "list": (
        "List studies, schemes and config groups, or what one name stands for.",
        "list tower",
        _add_list,
    ),
    "runs": (
        "List the runs in a folder: study, tuning, decided cells, date, what is missing.",
        "runs results",
        _add_runs,
    ),
}


def make_parser() -> Parser:
    """Return the parser of the whole command line, with a parser for each subcommand."""
    parser = Parser(prog=PROGRAM, description=DESCRIPTION)
    parser.add_argument(
        "--version", action="version", version=__version__, help="print the version and stop"
    )
    subparsers = parser.add_subparsers(
        dest="command", metavar="COMMAND", title="commands", parser_class=Parser
    )
    for name, (purpose, example, add_arguments) in COMMANDS.items():
        epilog = f"example: {PROGRAM} {example}"
        add_arguments(subparsers.add_parser(name, help=purpose, description=purpose, epilog=epilog))
    parser.commands = subparsers.choices
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line and return the exit code; errors are printed to stderr.

    `argv` holds the words after the program's name; None means those of `sys.argv`.
    """
    if "_ARGCOMPLETE" in os.environ:  # the shell asks for completions
        with suppress(ImportError):  # an extra
            import argcomplete

            argcomplete.autocomplete(make_parser())
    arguments = list(sys.argv[1:] if argv is None else argv)
    _warnings_to_stderr()
    try:
        return _run(arguments)
    except InputError as error:
        print(f"owtsweep: {error}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt as error:
        # The message of an interrupted sweep says how many cases are stored.
        text = str(error) or "interrupted; finished blocks are kept"
        print(f"owtsweep: {text}; the same command goes on from there", file=sys.stderr)
        if arguments[:1] in (["advise"], ["sweep"], ["replay"]):
            print(f"  {same_command(arguments)}", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # `owtsweep list | head`
        sys.stderr.close()
        return DONE
    except OSError as error:
        if error.errno in (errno.EMFILE, errno.ENFILE):
            text = "this process may not open more files; raise its limit (ulimit -n 1024)"
            print(f"owtsweep: {text}", file=sys.stderr)
            return BAD_INPUT
        print(f"owtsweep: {as_text(error)}", file=sys.stderr)  # stdout on a full disk, say
        return FAILED


def same_command(arguments: Sequence[str]) -> str:
    """Return the command line that continues a stopped command, quoted for a shell.

    `arguments` are the words of the stopped command. `--fresh` and `--yes` are left out, because
    they would delete the stored cases.
    """
    words = [word for word in arguments if word not in ("--fresh", "--yes")]
    return f"{program_here()} {shlex.join(words)}"


def program_here() -> str:
    """Return the words that start this program in the user's shell and current folder.

    They are `owtsweep` if the shell finds this environment's script by that name; else the path of
    the script, e.g. `.venv/bin/owtsweep`; without a script, `python -m owtsweep`.
    """
    script: str | None = sys.argv[0]
    if Path(sys.argv[0]).name != PROGRAM or not Path(sys.argv[0]).is_file():
        script = shutil.which(PROGRAM, path=str(Path(sys.executable).parent))
    if script is None:
        return "python -m owtsweep"
    found = shutil.which(PROGRAM)
    if found is not None and os.path.samefile(found, script):
        return PROGRAM
    from_here = os.path.relpath(script)
    below = os.sep in from_here and not from_here.startswith(os.pardir)
    return shlex.quote(from_here if below else script)


class _ToStderr(logging.Handler):
    """Prints each message to what `sys.stderr` is now, which a caller of `main` may exchange.

    A command that runs many configurations, e.g. `advise`, says a message once. said: those said.
    """

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.said: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        text = self.format(record)
        if text not in self.said:
            print(text, file=sys.stderr)
        self.said.add(text)


def _warnings_to_stderr() -> None:
    """Print logged warnings to stderr too, except those that begin with "failed: ".

    A warning says, for example, that a file of stored cases is damaged.
    """
    logger = logging.getLogger("owtsweep")
    for handler in logger.handlers:
        if isinstance(handler, _ToStderr):
            handler.said.clear()
    if not logger.handlers:
        handler = _ToStderr()
        handler.addFilter(lambda record: not str(record.msg).startswith("failed: "))
        handler.setFormatter(Lines("owtsweep: %(message)s"))
        logger.addHandler(handler)


def _run(arguments: list[str]) -> int:
    parser = make_parser()
    if not arguments:
        parser.print_help()
        return BAD_INPUT
    name = arguments[0]
    require(_here_exists(), "the current folder has been deleted; change to one that exists")
    require(name in COMMANDS or name.startswith("-"), _explain_unknown(name))
    studies = [word.partition("=")[2] for word in arguments if word.startswith("study=")]
    if name == "sweep" and studies and not {"-h", "--help"}.isdisjoint(arguments):
        from owtsweep.cli.keys import print_keys

        print_keys(studies[-1])
        return DONE
    if name in COMMANDS:
        # Intermixed parsing lets flags stand anywhere among the overrides.
        options = parser.commands[name].parse_intermixed_args(_without_cfg_kind(arguments))
    else:
        options = parser.parse_args(arguments)  # --help, or an error that names the commands
    module = import_module(f"owtsweep.cli.{name}")
    try:
        with no_modules_of_this_folder():
            return int(module.run(options, arguments))
    except Exception as error:
        raise_interrupt(error)
        raise


def _explain_unknown(name: str) -> str:
    """Return in a line that there is no command of this name, and which the user may have meant."""
    near = get_close_matches(name, COMMANDS, n=2, cutoff=0.5)
    hint = f"did you mean {' or '.join(near)}? " if near else ""
    return f"{shorten(name)}: there is no such command; {hint}`{PROGRAM} --help` lists all"


def raise_interrupt(error: BaseException) -> None:
    """Raise `KeyboardInterrupt` if `error` was raised while an interrupt was handled.

    Otherwise return. A library that is interrupted may raise an error of its own, which would
    hide the interrupt.
    """
    earlier = error.__context__
    while earlier is not None and not isinstance(earlier, KeyboardInterrupt):
        earlier = earlier.__context__
    if earlier is not None:
        raise KeyboardInterrupt from error


def _here_exists() -> bool:
    try:
        return bool(os.getcwd())
    except FileNotFoundError:
        return False


def _without_cfg_kind(arguments: list[str]) -> list[str]:
    """Return the arguments without the first, the subcommand's name.

    The word "job" after `--cfg` is left out too: `--cfg job` is Hydra's form of `--cfg`.
    """
    pairs = pairwise(arguments)
    return [word for before, word in pairs if (before, word) != ("--cfg", "job")]
