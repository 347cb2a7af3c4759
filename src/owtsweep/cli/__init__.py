"""The command line: one file per subcommand, whose `run(options, argv)` returns the exit code."""

from owtsweep.cli.program import BAD_INPUT, DONE, FAILED, INTERRUPTED, main, make_parser

__all__ = ["BAD_INPUT", "DONE", "FAILED", "INTERRUPTED", "main", "make_parser"]
