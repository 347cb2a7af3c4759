"""Makes users' schemes, which a configuration names by `{_target_: package.Class, ...}`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from owtsweep.errors import InputError, as_text, require
from owtsweep.studies.base.contract import Scheme

#: A scheme of any study.
AnyScheme = Scheme[Any, Any, Any]


def make_scheme(
    entry: Mapping[str, object], kind: type = Scheme, study: str = "<study>"
) -> AnyScheme:
    """Make a user's scheme of its entry, whose other keys are the arguments of the class.

    Parameters
    ----------
    entry
        The mapping `{_target_: package.Class, ...}`.
    kind
        The class of the study's schemes, from which the user's must derive.
    study
        The study's name.

    Raises
    ------
    InputError
        If the class cannot be imported or made, is no scheme or one of another study, or states
        something wrong of itself.
    """
    target = str(entry["_target_"])
    module_name, _, class_name = target.rpartition(".")
    require(
        class_name != "" and module_name.strip(".") != "" and not module_name.startswith("."),
        f"schemes: _target_: {target!r} names no class; use {{_target_: package.Class}}",
    )
    arguments = {str(key): value for key, value in entry.items() if key != "_target_"}
    advice = "the class must be importable (see PYTHONPATH) and take the given arguments"
    with blame_code(target, advice):
        made: object = getattr(import_module(module_name), class_name)
        if not (isinstance(made, type) and issubclass(made, Scheme)):
            raise InputError(f"it is no class that derives from owtsweep.schemes.{study}.Scheme")
        require(
            issubclass(made, kind),
            f"schemes: {target} is a scheme of study={made.study}, not of study={study}",
        )
        lacking = sorted(made.__abstractmethods__)
        require(not lacking, f"it lacks the method {' and '.join(lacking)}")
        scheme: AnyScheme = made(**arguments)
        require(isinstance(scheme, made), f"it makes a {type(scheme).__name__}")
        scheme.check_declared()
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
