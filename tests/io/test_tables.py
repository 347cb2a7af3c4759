"""The tables of a run: what is written reads back, to the same bits."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from owtsweep.errors import InputError
from owtsweep.io import tables
from owtsweep.io.tables import read_table, write_table

REFERENCE = sorted((Path(__file__).parents[2] / "results" / "reference").rglob("*.csv"))


def test_csv_reads_back_exactly(tmp_path):
    generator = np.random.default_rng(3)
    table = pd.DataFrame(
        {
            "scheme": ["NA", "", "None", "a,b"] * 500,
            "value": generator.standard_normal(2000) * 10.0 ** generator.integers(-200, 200, 2000),
            "n": np.arange(2000),
            "good": [True, False] * 1000,
        }
    )
    table["empty"] = np.nan
    table.loc[5, "value"] = np.nan
    table.loc[6, "value"] = 0.1 + 0.2
    write_table(tmp_path, "table", table)
    pd.testing.assert_frame_equal(read_table(tmp_path, "table"), table, check_exact=True)
    assert b"\r" not in (tmp_path / "table.csv").read_bytes()


def test_unknown_table_names_those_that_exist(tmp_path):
    write_table(tmp_path, "summary", pd.DataFrame({"a": [1]}))
    with pytest.raises(InputError, match=r"^best_scheme: .* it has summary$"):
        read_table(tmp_path, "best_scheme")


def test_a_table_is_written_as_pandas_writes_it(tmp_path):
    table = pd.DataFrame(
        {
            "text": ["plain", "with, comma", 'a "quote"', "", "two\nlines"],
            "float": [0.1 + 0.2, np.nan, 1e-300, -0.0, 4.0],
            "whole": [1, 2, 3, 4, 5],
            "flag": [True, False, True, False, True],
            "kind": pd.Categorical(["a", "b", "a", "a", "b"]),
        }
    )
    path = write_table(tmp_path, "table", table)
    assert path.read_text(encoding="utf-8") == table.to_csv(index=False, lineterminator="\n")


def test_every_number_is_written_as_repr_has_it(tmp_path):
    bits = np.random.default_rng(1).integers(0, 2**63, 20_000).astype(np.uint64)
    powers = 10.0 ** np.arange(-320, 309)
    ordinary = np.random.default_rng(2).lognormal(0.0, 8.0, 20_000)
    numbers = np.concatenate([bits.view(float), powers, np.nextafter(powers, 0.0), ordinary])
    numbers = np.concatenate([numbers, -numbers, np.round(ordinary, 3), np.round(ordinary)])
    table = pd.DataFrame({"number": numbers, "row": np.arange(len(numbers))})
    path = write_table(tmp_path, "table", table)
    assert path.read_text(encoding="utf-8") == table.to_csv(index=False, lineterminator="\n")


@pytest.mark.parametrize("path", REFERENCE, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_a_stored_table_is_written_again_as_it_was(path, tmp_path):
    written = write_table(tmp_path, path.stem, read_table(path.parent, path.stem))
    assert written.read_bytes() == path.read_bytes()


GOOD = b"name,value\n" + b"MKF,0.1\n" * 1000


@pytest.mark.parametrize(
    "content",
    [
        b"", b"\n", b"a,b\n1,2,3\n", b"a,b\n1\n", b"a,a\n1,2\n", b",\n1,2\n", b"\0" * 99,
        b'"' * 999, GOOD + b'"MKF,0.1\n' + GOOD, GOOD + b"MK\0F,0.1\n", GOOD + b"M" * 10_000_000,
        GOOD + b"MKF\n" + GOOD, GOOD + b"MKF,1,2\n" + GOOD, GOOD + b"M\xffF,1\n",
    ],
    ids=range(14),
)  # fmt: skip
def test_a_damaged_table_gives_one_line(content, tmp_path):
    (tmp_path / "summary.csv").write_bytes(content)
    with pytest.raises(InputError, match=r"summary\.csv: this is no table; run its sweep again$"):
        read_table(tmp_path, "summary")


def test_text_among_numbers_and_long_fields_are_read_as_they_are(tmp_path):
    long = "M" * 10_000_000
    (tmp_path / "summary.csv").write_text(GOOD.decode() + f'{long},text\n"a,""b""\nc",2020-01-01\n')
    table = read_table(tmp_path, "summary")
    assert table["value"].tolist() == ["0.1"] * 1000 + ["text", "2020-01-01"]
    assert table["name"].tolist()[-2:] == [long, 'a,"b"\nc']


def test_a_header_alone_is_a_table_without_rows(tmp_path):
    (tmp_path / "summary.csv").write_text("a,b\n")
    table = read_table(tmp_path, "summary")
    assert (list(table.columns), len(table)) == (["a", "b"], 0)


@pytest.mark.parametrize("version", ["2.2.2", "3.0.1", "3.1.1", "4.0.0rc1"])
def test_older_versions_of_pandas_are_told_to_read_exactly(version):
    assert tables._is_exact(version) == (version[:3] in ("3.1", "4.0"))


@pytest.mark.parametrize("put", [os.mkfifo, Path.mkdir, lambda path: path.symlink_to(path)])
def test_what_is_no_file_is_no_table(put, tmp_path):
    put(tmp_path / "summary.csv")
    with pytest.raises(InputError, match=r"summary\.csv: (this is a|cannot be read)"):
        read_table(tmp_path, "summary")
