"""Times with dates become seconds; what follows the rows of a table is left out, and told."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
import writers

from owtsweep.errors import InputError
from owtsweep.motion.recorded import describe, read
from owtsweep.motion.recorded.formats import streams

TIME = np.arange(100) / 20.0
X = np.round(np.sin(TIME), 4)
START = datetime(2024, 5, 1, 23, 59, 58, tzinfo=UTC)  # the day ends inside the record
STAMPS = [START + timedelta(seconds=float(t)) for t in TIME]


def text_of(stamps: list[str], between: str = ",") -> str:
    rows = [between.join((stamp, f"{x:.4f}")) for stamp, x in zip(stamps, X, strict=True)]
    return "\n".join([between.join(("time", "x")), *rows]) + "\n"


def refusal(path: Path, text: str, **how: object) -> str:
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read(path, **how)
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    assert "\n" not in said
    return said


FORMS: dict[str, Callable[[datetime], str]] = {
    "zone": lambda t: t.isoformat(timespec="milliseconds").replace("+00:00", "Z"),
    "offset": lambda t: (t + timedelta(hours=2)).strftime("%Y-%m-%dT%H:%M:%S.%f+02:00"),
    "no zone": lambda t: t.strftime("%Y-%m-%dT%H:%M:%S.%f"),
    "blank": lambda t: t.strftime("%Y-%m-%d %H:%M:%S.%f"),
    "nine digits": lambda t: t.strftime("%Y-%m-%dT%H:%M:%S.%f") + "000Z",
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("between", [",", ";", "\t", " "])
def test_iso_times_become_seconds_from_the_first(tmp_path: Path, form: str, between: str) -> None:
    if form == "blank" and between == " ":
        pytest.skip("refused: two columns")
    path = tmp_path / "r.csv"
    path.write_text(text_of([FORMS[form](stamp) for stamp in STAMPS], between))
    recording = read(path)
    np.testing.assert_allclose(recording.time, TIME, rtol=0.0, atol=1e-9)
    np.testing.assert_array_equal(recording.channels["position_x"], X)
    assert not any("time in s" in note for note in recording.notes)


def test_iso_times_in_pieces_with_quotes_and_decimal_commas(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(streams, "BLOCK", 400)
    monkeypatch.setattr(streams, "TAIL", 200)
    path = tmp_path / "r.csv"
    rows = [f'"{s:%Y-%m-%dT%H:%M:%S},{s:%f}";{x:.4f}'.replace(".", ",") for s, x in
            zip(STAMPS, X, strict=True)]  # fmt: skip
    path.write_text("\n".join(["time;x", *rows]) + "\n")
    np.testing.assert_allclose(read(path).time, TIME, rtol=0.0, atol=1e-9)
    np.testing.assert_array_equal(read(path).channels["position_x"], X)
    assert "time              = time  ISO 8601, 0 to 4.95" in describe(path)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda s: s[:50] + [t.removesuffix("Z") for t in s[50:]], "some times state Z"),
        (lambda s: s[:50] + ["12.5"] * 50, "but also '12.5'"),
        (lambda s: s[:50] + ["2024-05-01"] * 50, "but also '2024-05-01'"),
        (lambda s: ["01/05/2024 12:00:00"] * 100, "times like 01/05/2024 12:00:00: write date and"),
        (lambda s: ["12:00:00.5"] * 100, "times like 12:00:00.5: write date and time in ISO 8601"),
        (lambda s: ["2024-13-01T12:00:00Z"] * 100, "no such time"),
        (lambda s: s[:50] + s[:50], "goes backwards in data row 51"),
        (lambda s: [*s[:50], "", *s[51:]], "is missing in data row 51"),
    ],
)
def test_mixed_and_ambiguous_times_are_refused(tmp_path: Path, change, said: str) -> None:
    stamps = change([FORMS["zone"](stamp) for stamp in STAMPS])
    assert said in refusal(tmp_path / "r.csv", text_of(stamps))


def test_refused_before_any_guess(tmp_path: Path) -> None:
    blanks = text_of([FORMS["blank"](stamp) for stamp in STAMPS], " ")
    assert "line 2 has date and time as two columns: write T" in refusal(tmp_path / "r.txt", blanks)
    zoned = text_of([FORMS["zone"](stamp) for stamp in STAMPS])
    assert "leave out units.time" in refusal(tmp_path / "r.csv", zoned, units={"time": "ms"})


def fast(tmp_path: Path) -> Path:
    table = {"Time": ("s", TIME), "TTDspFA": ("m", X), "TTDspSS": ("m", 0.5 * X)}
    return writers.fast_text(tmp_path / "r.out", table)


FOOTER = "\nThe end of the simulation.\n OpenFAST terminated normally after 12 s.\n"


def test_a_footer_is_left_out_and_told(tmp_path: Path) -> None:
    for path in (fast(tmp_path), tmp_path / "r.csv", tmp_path / "r.csv.gz", tmp_path / "r.txt"):
        raw = path.read_bytes() if path.exists() else text_of([f"{t:g}" for t in TIME]).encode()
        if path.suffix == ".txt":
            raw = raw.replace(b",", b" ")
        raw += FOOTER.encode()
        path.write_bytes(gzip.compress(raw) if path.suffix == ".gz" else raw)
        recording = read(path)
        np.testing.assert_allclose(recording.time, TIME)
        said = "2 line(s) below the table are left out, the first is 'The end of the simulation.'"
        assert said in recording.notes
        assert f"note: {said}" in describe(path)


@pytest.mark.parametrize("lost", [1, 2, 7, 17, 33])
def test_a_cut_last_line_of_fast_is_left_out_and_told(tmp_path: Path, lost: int) -> None:
    path = fast(tmp_path)
    whole = path.read_bytes().rstrip()
    path.write_bytes(whole[:-lost])
    recording = read(path)
    np.testing.assert_allclose(recording.time, TIME[:-1])
    assert sum("the last line was cut off and is left out" in n for n in recording.notes) == 1
    path.write_bytes(whole)  # only the line end is missing: nothing is lost
    np.testing.assert_allclose(read(path).time, TIME)
    assert not any("left out" in note for note in read(path).notes)


def test_a_cut_last_line_of_csv(tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    path.write_text(text_of([f"{t:g}" for t in TIME]) + "5")
    assert len(read(path).time) == 100
    assert "the last line was cut off and is left out: '5'" in read(path).notes


def test_the_middle_of_a_file_is_not_mended(tmp_path: Path) -> None:
    good = text_of([f"{t:g}" for t in TIME])
    lines = good.splitlines()
    for between, wrong in (
        (",", "2.425"),
        (" ", "2.425"),
        (",", "a b c"),
        (" ", "broken here now"),
    ):
        text = "\n".join([*lines[:50], wrong, *lines[50:]]).replace(",", between) + "\n"
        refusal(tmp_path / "r.csv", text)
    refusal(tmp_path / "r.csv", good + "no number\n" * 21)  # too much to be a footer
    refusal(tmp_path / "r.csv", good + "5\n")  # a line with an end was not cut
