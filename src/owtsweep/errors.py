"""Errors that a user can act on."""


class InputError(ValueError):
    """Bad input: one line that names the argument, says what is wrong and what would work.

    The command line prints it without a traceback and exits with code 2; nothing has been
    written by then.
    """


def as_text(error: BaseException) -> str:
    """Any exception's type and message in one line."""
    return " ".join(f"{type(error).__name__}: {error}".split())
