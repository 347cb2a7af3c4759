"""The subcommands, one module each with `run(options, argv) -> exit code`."""
