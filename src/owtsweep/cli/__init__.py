"""The command line: one file per subcommand, each with `run(options, argv) -> exit code`."""

from owtsweep.cli.program import BAD_INPUT, DONE, FAILED, INTERRUPTED, main, make_parser

__all__ = ["BAD_INPUT", "DONE", "FAILED", "INTERRUPTED", "main", "make_parser"]
