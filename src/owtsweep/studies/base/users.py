"""Makes users' schemes, which a configuration names by `{_target_: package.Class, ...}`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from owtsweep.errors import InputError, as_text, require

#: Most characters of a scheme's name: it stands in the cells and legends of figures.
LONGEST_NAME = 60


def instantiate(entry: Mapping[str, Any], method: str, check: Callable[[Any, str], object]) -> Any:
    """Make a user's scheme of its entry, whose other keys are the arguments of the class.

    Parameters
    ----------
    entry
        The mapping `{_target_: package.Class, ...}`.
    method
        The method that the class must have, e.g. "prepare(known)".
    check
        Function that checks the scheme; it is called with the scheme and the name of its class, and
        raises `InputError`.

    Raises
    ------
    InputError
        If the class cannot be imported or made, lacks the method, or is refused by `check`.
    """
    target = entry["_target_"]
    module_name, _, class_name = str(target).rpartition(".")
    require(
        class_name != "" and module_name.strip(".") != "" and not module_name.startswith("."),
        f"schemes: _target_: {target!r} names no class; use {{_target_: package.Class}}",
    )
    arguments = {str(key): value for key, value in entry.items() if key != "_target_"}
    advice = "the class must be importable (see PYTHONPATH) and take the given arguments"
    with blame_code(target, advice):
        made = getattr(import_module(module_name), class_name)
        require(
            isinstance(made, type) and callable(getattr(made, method.partition("(")[0], None)),
            f"it is no class with a method {method}",
        )
        scheme = made(**arguments)
        check(scheme, target)
        str(getattr(made, "version", ""))  # a property that raises would do so in a sweep
    return scheme


@contextmanager
def blame_code(target: str, advice: str) -> Iterator[None]:
    """Turn every exception of a scheme's code into an InputError of one line.

    Raises
    ------
    InputError
        Instead of any exception inside the context, except KeyboardInterrupt, which is not changed.
        The message names the scheme by `target` and ends with `advice`. But if the exception was an
        InputError, the message ends with the text of that InputError.
    """
    try:
        yield
    except InputError as error:
        told = str(error)
        raise InputError(
            told if told.startswith("schemes: ") else f"schemes: {target} is no scheme: {told}"
        ) from None
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # it may even call sys.exit()
        raise InputError(
            f"schemes: {target} cannot be made ({as_text(error)}); {advice}"
        ) from error


def check_name(name: Any) -> None:
    """Check that a scheme's name can be shown in tables, figures and a terminal.

    Raises
    ------
    InputError
        If the name is not a text, is empty, has more than `LONGEST_NAME` characters, or contains a
        character that cannot be printed.
    """
    require(
        isinstance(name, str) and 0 < len(name) <= LONGEST_NAME and name.isprintable(),
        f"schemes: the name {str(name)[:LONGEST_NAME]!r} cannot be used; give one of 1 to "
        f"{LONGEST_NAME} printable characters",
    )
