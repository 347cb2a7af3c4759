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
from typing import Any, NoReturn

from owtsweep._version import __version__
from owtsweep.errors import InputError, as_text, require, shorten
from owtsweep.process import no_modules_of_this_folder
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


#: An argument of a subcommand: its names, and what `ArgumentParser.add_argument` takes besides.
Argument = tuple[tuple[str, ...], dict[str, Any]]


def _take(words: str, help: str, **more: Any) -> Argument:
    """Return an argument: `words` are its name and what stands for its value, e.g. "run RUN"."""
    name, metavar = words.split()
    return (name,), {"metavar": metavar, "help": help, **more}


def _flag(names: str, help: str) -> Argument:
    return tuple(names.split()), {"action": "store_true", "help": help}


def _overrides(example: str) -> Argument:
    return _take("overrides override", f"Hydra override, e.g. {example}", nargs="*")


CONFIG_DIR = _take("--config-dir DIR", "folder with more config groups")
DRY_RUN = _flag("--dry-run", "say what would be computed, in what time, and stop")
RUN = _take("run RUN", "folder of a run, e.g. results/default-0a1b2c3d4e")
RUN_OPTIONS = (
    _flag("--cfg", "print the resolved configuration with units and stop"),
    DRY_RUN,
    CONFIG_DIR,
    _flag("--fresh", "delete this run's cases, tables and figures, and start over"),
    _flag("--yes", "do not ask before deleting"),
)
#: Name of a subcommand -> what it does, an example, and its arguments. The module of a subcommand
#: is owtsweep.cli.<name>.
COMMANDS: dict[str, tuple[str, str, *tuple[Argument, ...]]] = {
    "advise": (
        "Say which estimator to run in one case, how good it is, and what would change that.",
        "advise natural_period=3.2 amplitude=0.5 sensors.gnss.rate=10",
        _overrides("natural_period=3.2"),
        _flag("--quick", "the answer alone, without levers and other worlds"),
        _flag("--json", "print one JSON object instead of sentences"),
        CONFIG_DIR,
    ),
    "sweep": (
        "Run a study, or finish one that was stopped, and draw its map.",
        "sweep grid.replicates=2 schemes=[MKF,HME1] tuning=matched",
        _overrides("grid.replicates=2 (`--help study=NAME` shows a study's keys)"),
        _flag("-m --multirun", "one run for each value of a=1,2,3"),
        *RUN_OPTIONS,
    ),
    "replay": (
        "Run the schemes on recorded motion or recorded sensors; say which one to run.",
        "replay towertop.outb columns.position_x=TwHt1TPxi",
        _take("words FILE|override", "records or patterns; key=value words", nargs="*"),
        _flag("--describe", "list channels, units, rates and gaps, and stop"),
        _flag("--sample", "write two sample records into this folder, and stop"),
        *RUN_OPTIONS,
    ),
    "figures": (
        "Draw all figures and tables of a run into its folder figures/.",
        "figures results/default-0a1b2c3d4e",
        RUN,
        _take(
            "--envelope STRUCTURE",
            "only the map, with where a structure is on it: a name in conf/structure or a YAML "
            "file",
        ),
    ),
    "report": (
        "Write report.html, one page of a run to send: it opens offline, in any browser.",
        "report results/default-0a1b2c3d4e",
        RUN,
        _take("--output FILE", "the file to write; default: report.html in the run's folder"),
        _flag(
            "--details", "run record 0 of each cell once more, and show 40 s of truth and estimates"
        ),
    ),
    "fidelity": (
        "Judge the claims of a study's paper, or yours, by a run; writes RUN/fidelity/.",
        "fidelity results/default-0a1b2c3d4e",
        RUN,
        _take("--claims FILE", "a file of claims (TOML) instead of those of the study's paper"),
    ),
    "compare": (
        "Compare the runs of a multirun, or some runs: how the map moves with what was changed.",
        "compare results/multirun-0a1b2c3d4e",
        _take("runs RUN", "folder of a multirun, or folders of several runs", nargs="+"),
    ),
    "spectrum": (
        "Draw the schemes' error spectra and noise floors, without any record (study=hub).",
        "spectrum tuning=matched sensors.gnss.delay=0.4",
        _overrides("tuning=matched"),
        CONFIG_DIR,
    ),
    "tune": (
        "Search the schemes' best numbers for these sensors; writes a tuning=FILE.",
        "tune sensors.gnss.rate=5 --output mine.yaml",
        _overrides("sensors.gnss.rate=5"),
        _flag("--dry-run", "say what would be searched, in what time, and stop"),
        CONFIG_DIR,
        _take("--output FILE", "the tuning file to write; default tuned-<hash>.yaml"),
    ),
    "vary": (
        "Draw each scheme's error over the values of one key, e.g. a GNSS rate.",
        "vary sensors.gnss.rate=1,2,5,10 grid.natural_period=[4]",
        _overrides("sensors.gnss.rate=1,2,5,10"),
        _flag("--cfg", "print the configuration of each value with units and stop"),
        DRY_RUN,
        CONFIG_DIR,
    ),
    "place": (
        "Say how many inclinometers are enough, and where, before any is mounted (study=tower).",
        "place study=tower structure=./my_tower.yaml grid.noise=[3]",
        _overrides("structure=./my_tower.yaml"),
        _take("--quantity NAME", "whose error counts: stress (default) or base_moment"),
        _take("--count N", "most sensors to choose; default 8", type=int),
        _take(
            "--heights LIST",
            "to choose from, in m above the ground, e.g. 10,25,40; default: all ends of elements",
        ),
        CONFIG_DIR,
    ),
    "show": (
        "Tell what a run is: versions, seed, command line, times, cases, failures.",
        "show results/default-0a1b2c3d4e",
        RUN,
    ),
    "init": (
        "Write a first scheme, structure or study of your own, to be changed by you.",
        "init scheme my_filter study=floater",
        (("kind",), {"help": "what to write", "choices": ("scheme", "structure", "study")}),
        _take("name NAME", "its name, e.g. my_filter"),
        _take(
            "overrides study=...", "of a scheme: study=hub (default), tower, floater or blade",
            nargs="*",
        ),
    ),
    "list": (
        "List studies, schemes and config groups, or what one name stands for.",
        "list tower",
        _take(
            "names NAME",
            "a study, a config group, or a scheme, e.g. tower, sensors or HME1; default: all; "
            "with study=STUDY, of this study alone",
            nargs="*",
        ),
    ),
    "runs": (
        "List the runs in a folder: study, tuning, decided cells, date, what is missing.",
        "runs results",
        _take(
            "folder FOLDER", "the folder that holds the runs; default: results", nargs="?",
            default="results",
        ),
    ),
}  # fmt: skip


def make_parser() -> Parser:
    """Return the parser of the whole command line, with a parser for each subcommand."""
    parser = Parser(prog=PROGRAM, description=DESCRIPTION)
    parser.add_argument(
        "--version", action="version", version=__version__, help="print the version and stop"
    )
    subparsers = parser.add_subparsers(
        dest="command", metavar="COMMAND", title="commands", parser_class=Parser
    )
    for name, (purpose, example, *arguments) in COMMANDS.items():
        epilog = f"example: {PROGRAM} {example}"
        of_name = subparsers.add_parser(name, help=purpose, description=purpose, epilog=epilog)
        for names, options in arguments:
            added: Any = of_name.add_argument(*names, **options)
            if names == ("overrides",):
                added.completer = complete_override
    parser.commands = subparsers.choices
    return parser


def complete_override(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Complete an override in the shell, as the package argcomplete asks.

    Return the studies, then options of groups and keys of the study that is named, or the
    hub. argcomplete offers those of them that begin as the word that is typed.
    """
    from owtsweep.config.hints import list_keys
    from owtsweep.studies import names
    from owtsweep.studies.registry import DEFAULT, find_tree

    given = parsed_args.overrides
    named = [word.removeprefix("study=") for word in given if word.startswith("study=")]
    try:
        tree = find_tree(named[-1] if named else DEFAULT)
    except InputError:  # an override before this one is wrong; the command will say so
        return []
    keys = list_keys(tree.model)
    sections = {key.rpartition(".")[0] for key in keys}
    return [
        *(f"study={name}" for name in names()),
        *(f"{group}={option}" for group in tree.groups() for option in tree.options(group)),
        *(f"{key}=" for key in keys if key not in sections),
    ]


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
