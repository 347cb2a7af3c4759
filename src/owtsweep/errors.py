"""Errors that a user can act on, and text that a terminal can be given."""

#: Most characters of a message: what is longer is a value that fills the screen.
LONGEST = 1000


class InputError(ValueError):
    """Bad input. The message is one line: the argument, what is wrong, what would work.

    The command line prints it without a traceback and exits with code 2, before anything is
    written. What is bad may come from a file of another person, so the message is `printable`, and
    its middle is left out if it is long.
    """

    def __init__(self, message: str) -> None:
        super().__init__(printable(shorten(message)))


def require(condition: bool, message: str) -> None:
    """Raise `InputError(message)` unless the condition holds."""
    if not condition:
        raise InputError(message)


def as_text(error: BaseException) -> str:
    """Type and message of an exception, in one printable line."""
    try:
        message = str(error)
    except Exception:  # an exception class of a user's may have a broken __str__
        message = "its message cannot be made"
    return printable(shorten(" ".join(f"{type(error).__name__}: {message}".split())))


def shorten(text: str, most: int = LONGEST) -> str:
    """A text of at most so many characters: without its middle if it is longer."""
    if len(text) <= most:
        return text
    half = (most - len(" ... ")) // 2
    return f"{text[:half]} ... {text[-half:]}"


def printable(text: str) -> str:
    r"""A text with escapes (`\x1b`) in place of all characters that a terminal would obey.

    These are control characters, line breaks, marks that reverse the direction of writing, and
    halves of characters (surrogates), which cannot be printed at all.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
