"""The command line: each subcommand has a file, and its function `run` returns the exit code."""

from owtsweep.cli.program import BAD_INPUT, DONE, FAILED, INTERRUPTED, main, make_parser

__all__ = ["BAD_INPUT", "DONE", "FAILED", "INTERRUPTED", "main", "make_parser"]
