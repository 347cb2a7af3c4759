"""The command line: one file per subcommand, each with `run(options, argv) -> exit code`."""

from owtsweep.cli.program import (
    BAD_INPUT,
    DONE,
    FAILED,
    INTERRUPTED,
    PROGRAM,
    main,
    make_parser,
    same_command,
)

__all__ = [
    "BAD_INPUT", "DONE", "FAILED", "INTERRUPTED", "PROGRAM", "main", "make_parser", "same_command",
]  # fmt: skip
