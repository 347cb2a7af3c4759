"""Messages are one printable line, whatever they quote."""

from __future__ import annotations

import pickle

import pytest

import owtsweep
from owtsweep.errors import InputError, as_text, printable

HOSTILE = "a\x1b[31mb\nc\rd\x07e\u202ef\ud800g\x00h\u2028i"


def test_what_a_terminal_would_obey_is_escaped() -> None:
    shown = r"a\x1b[31mb\nc\rd\x07e\u202ef\ud800g\x00h\u2028i"
    assert printable(HOSTILE) == shown
    assert str(InputError(HOSTILE)) == shown
    assert printable(shown) == shown
    assert str(pickle.loads(pickle.dumps(InputError(HOSTILE)))) == shown
    assert as_text(ValueError("a\x1bb\n  c")) == r"ValueError: a\x1bb c"
    assert printable("Größe 3 m²/s² – §5.2 – 日本") == "Größe 3 m²/s² – §5.2 – 日本"


def test_an_exception_that_cannot_be_printed_is_named() -> None:
    class Broken(Exception):
        def __str__(self) -> str:
            raise RuntimeError

    assert as_text(Broken()) == "Broken: its message cannot be made"
    with pytest.raises(InputError):
        raise InputError(as_text(Broken()))


@pytest.mark.parametrize("wrong", [None, [5], [b"x"], "seed=1"])
@pytest.mark.parametrize("function", ["estimate", "run"])
def test_overrides_that_are_no_list_of_texts_are_told(function: str, wrong: object) -> None:
    with pytest.raises(owtsweep.InputError, match=r"^overrides: .* list of texts"):
        getattr(owtsweep, function)(wrong)
    with pytest.raises(owtsweep.InputError, match=r"^overrides: .* list of texts"):
        owtsweep.online("HME1", wrong)  # type: ignore[arg-type]
    with pytest.raises(owtsweep.InputError, match=r"^overrides: .* list of texts"):
        owtsweep.replay("record.csv", wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("wrong", [None, 5, b"run"])
def test_a_run_that_is_no_path_is_told(wrong: object) -> None:
    with pytest.raises(owtsweep.InputError, match=r"^path: .* is no path"):
        owtsweep.load(wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("wrong", [None, 5, [5]])
def test_files_that_are_no_paths_are_told(wrong: object) -> None:
    with pytest.raises(owtsweep.InputError, match=r"^files: .* is no path; give one, or a list"):
        owtsweep.replay(wrong)  # type: ignore[arg-type]
