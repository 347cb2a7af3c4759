"""Long lists of numbers past Hydra and YAML, which take a fifth of a millisecond for each number.

A grid may have a thousand amplitudes. In an override such a list is replaced by a mark, and put in
its place again once the configuration is composed; in YAML likewise. Whoever reads the result sees
no difference; whatever is not plain is left to Hydra and YAML themselves.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

#: Lists of fewer numbers go the ordinary way.
LONG = 32
_MARK = "owtsweep-numbers-{}-of-this-process"
_NUMBER = r"-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?"
_OVERRIDE = re.compile(rf"([A-Za-z_][A-Za-z_.]*)=\[ *({_NUMBER}(?: *, *{_NUMBER})*) *\]")


class Marks:
    """Lists and the words that stand for them."""

    def __init__(self) -> None:
        self.lists: dict[str, list[Any]] = {}

    def put(self, numbers: list[Any]) -> str:
        """A word for a list."""
        mark = _MARK.format(len(self.lists))
        self.lists[mark] = numbers
        return mark

    def back(self, value: Any) -> Any:
        """Mappings and lists with a list in the place of each word.

        Raises
        ------
        ValueError
            If a word has become part of another text.
        """
        if isinstance(value, dict):
            return {key: self.back(item) for key, item in value.items()}
        if isinstance(value, list):
            return [self.back(item) for item in value]
        if isinstance(value, str) and value in self.lists:
            return list(self.lists[value])
        if isinstance(value, str) and any(mark in value for mark in self.lists):
            raise ValueError(value)
        return value


def shortened(overrides: Sequence[str]) -> tuple[list[str], Marks]:
    """Overrides with a word for each long list of plain numbers."""
    marks = Marks()
    return [_shortened(override, marks) for override in overrides], marks


def _shortened(override: str, marks: Marks) -> str:
    if override.count(",") + 1 < LONG:
        return override
    found = _OVERRIDE.fullmatch(override)
    if found is None:
        return override
    words = found[2].replace(" ", "").split(",")
    return f"{found[1]}={marks.put([float(w) if '.' in w else int(w) for w in words])}"


def marked(value: Any, marks: Marks) -> Any:
    """Mappings and lists with a word for each long list of floats that YAML writes as `repr`."""
    if isinstance(value, dict):
        return {
            key: marks.put(item) if _is_plain(item) else marked(item, marks)
            for key, item in value.items()
        }
    return value


def _is_plain(value: Any) -> bool:
    if not isinstance(value, list) or len(value) < LONG:
        return False
    return all(type(item) is float and (item == 0.0 or 1e-4 <= abs(item) < 1e15) for item in value)


def in_yaml(text: str, marks: Marks) -> str:
    """YAML with the lists in the place of their words, which are values of keys there."""
    for mark, numbers in marks.lists.items():
        found = re.search(rf"^( *)(.*): {mark}$", text, re.MULTILINE)
        if found is None:
            raise ValueError(mark)
        lines = [f"{found[1]}{found[2]}:", *(f"{found[1]}- {number!r}" for number in numbers)]
        text = text[: found.start()] + "\n".join(lines) + text[found.end() :]
    return text
