"""The command line, with one file per subcommand.

The function `run` in the file of a subcommand carries out the subcommand and returns the exit code.
"""

from owtsweep.cli.program import BAD_INPUT, DONE, FAILED, INTERRUPTED, main, make_parser

__all__ = ["BAD_INPUT", "DONE", "FAILED", "INTERRUPTED", "main", "make_parser"]
