"""Help with the words of a replay: files that are not there, names of channels and units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path

#: An override whose value is the name of a channel or of a unit.
_TEXT = re.compile(r"((?:columns|units)\.\w+)=(.*)", re.DOTALL)
#: Values that Hydra takes as they are.
_PLAIN = re.compile(r"[\w./-]*")


def quote_texts(overrides: Sequence[str]) -> list[str]:
    """Quote names of channels and units that Hydra would not take as they are.

    So `units.specific_force_x=m/s^2` and `columns.position_x=TwHt1TPxi [m]` work as they are typed.
    Other overrides, and values that have quotes or refer to another key (`${...}`), are returned
    unchanged.
    """
    return [_quote(word) for word in overrides]


def _quote(word: str) -> str:
    found = _TEXT.fullmatch(word)
    if found is None:
        return word
    key, value = found.groups()
    value = value.strip()
    if _PLAIN.fullmatch(value) or value[0] in "'\"" or "${" in value:
        return word
    escaped = re.sub(r"(\\*)'", r"\1\1\\'", value)
    return f"{key}='{escaped}'"


def tell_missing(word: str, path: Path) -> str:
    """Return why a word names no file; name the most similar file of its folder, if there is one.

    `word` is a path or a pattern as the user wrote it; `path` is the same with the home folder
    written out.
    """
    if any(sign in word for sign in "*?["):
        return f"{word}: nothing matches this pattern"
    if "://" in word:
        return f"{word}: files are not read from the network; download this one first"
    try:
        names = [entry.name for entry in path.parent.iterdir() if entry.is_file()]
    except OSError:  # the folder is not there, or may not be read
        return f"{word}: there is no such file, and no folder {path.parent}"
    near = get_close_matches(path.name, names, n=1)
    hint = f"; did you mean {Path(word).parent / near[0]}?" if near else ""
    return f"{word}: there is no such file{hint}"
