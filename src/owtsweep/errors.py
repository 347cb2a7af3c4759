"""Errors that a user can act on."""


class InputError(ValueError):
    """Bad input. The message is one line: the argument, what is wrong, what would work.

    The command line prints it without a traceback and exits with code 2, before anything is
    written.
    """


def require(condition: bool, message: str) -> None:
    """Raise `InputError(message)` unless the condition holds."""
    if not condition:
        raise InputError(message)


def as_text(error: BaseException) -> str:
    """Type and message of an exception, in one line."""
    return " ".join(f"{type(error).__name__}: {error}".split())
