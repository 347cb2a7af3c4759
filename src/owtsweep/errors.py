"""Errors that a user can act on, and text that can be shown in a terminal."""

#: Most characters of a message: a longer message holds a value that would fill the screen.
LONGEST = 1000


class InputError(ValueError):
    """The error for bad input; its message names the argument, what is wrong, and what would work.

    The command line prints the message without a traceback and exits with code 2. The message may
    quote a file that another person made, so it is made one printable line (`printable`), and the
    middle of a long one is left out (`shorten`).

    >>> import owtsweep
    >>> try:
    ...     owtsweep.run(["sensors.gnss.delai=0.4"])
    ... except owtsweep.InputError as error:
    ...     print(error)
    sensors.gnss.delai: there is no such key; did you mean sensors.gnss.delay?
    """

    def __init__(self, message: str) -> None:
        super().__init__(printable(shorten(message)))


def require(condition: bool, message: str) -> None:
    if not condition:
        raise InputError(message)


def as_text(error: BaseException) -> str:
    """Return the type and the message of an exception in one printable line, the middle cut out.

    If the exception cannot make its message, the line says so.
    """
    try:
        message = str(error)
    except Exception:  # an exception class of a user's may have a broken __str__
        message = "its message cannot be made"
    return printable(shorten(" ".join(f"{type(error).__name__}: {message}".split())))


def shorten(text: str, most: int = LONGEST) -> str:
    """Return the text; if it is longer than `most` characters, replace its middle by " ... "."""
    if len(text) <= most:
        return text
    half = (most - len(" ... ")) // 2
    return f"{text[:half]} ... {text[-half:]}"


def printable(text: str) -> str:
    r"""Return the text with an escape such as `\x1b` in place of each unprintable character.

    These are control characters, line breaks, marks that reverse the direction of writing, and
    halves of characters (surrogates). A terminal would obey the first three kinds.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
