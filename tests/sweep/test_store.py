"""The store: exact rows back, or none."""

from __future__ import annotations

import logging

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from owtsweep.errors import InputError
from owtsweep.sweep.store import Store, encode

KEY = "0" * 31 + "1"
OTHER = "0" * 31 + "2"


@pytest.fixture
def rows():
    generator = np.random.default_rng(1)
    return pd.DataFrame(
        {
            "scheme": ["EKF", "Größe", ""],
            "replicate": [0, 1, 2],
            "value": generator.standard_normal(3) * [1e-300, 1.0, 1e300],
            "amplitude": [np.nan, 0.1 + 0.2, -0.0],
            "flag": [True, False, True],
            "status": "ok",
            "reason": "",
        }
    )


@pytest.fixture
def store(tmp_path, rows):
    store = Store(tmp_path)
    store.cases.mkdir()
    store.write(KEY, encode(KEY, rows, {"schema_version": "3"}))
    return store


def damaged(store):
    return sorted(path.name for path in store.cases.glob("*.damaged"))


def test_rows_read_back_to_the_same_bits_and_types(store, rows):
    read = store.read(KEY)
    pd.testing.assert_frame_equal(read, rows, check_exact=True)
    assert read["value"].to_numpy().tobytes() == rows["value"].to_numpy().tobytes()
    assert read["scheme"].dtype == rows["scheme"].dtype


def test_file_is_parquet_with_key_versions_and_page_checksums(store):
    file = pq.ParquetFile(store.path(KEY), page_checksum_verification=True)
    assert file.metadata.metadata[b"owtsweep.key"] == KEY.encode()
    assert file.metadata.metadata[b"owtsweep.schema_version"] == b"3"
    assert file.read().num_rows == 3


def test_same_rows_make_the_same_file(store, rows):
    before = store.path(KEY).read_bytes()
    store.write(KEY, encode(KEY, rows, {"schema_version": "3"}))
    assert store.path(KEY).read_bytes() == before


def test_missing_shard(store):
    assert store.read(OTHER) is None
    assert store.status(OTHER) == "missing"


def test_a_shard_that_another_sweep_writes_meanwhile_needs_no_warning(store, caplog, monkeypatch):
    def read_too_early(path, *_, **__):
        path.write_bytes(b"whole a moment later")
        raise InputError(f"{path}: there is no such file")

    monkeypatch.setattr("owtsweep.sweep.store.read_bytes", read_too_early)
    assert store.statuses("none") is None
    assert not caplog.records


def test_every_flipped_byte_is_seen(store, caplog):
    """Wherever it is: magic, pages, page headers, footer, our own metadata."""
    path = store.path(KEY)
    whole = path.read_bytes()
    caplog.set_level(logging.ERROR)
    for place in range(0, len(whole), 7):
        broken = bytearray(whole)
        broken[place] ^= 0x10
        path.write_bytes(broken)
        assert store.status(KEY) == "missing", place
        assert not path.exists()
        (store.cases / f"{path.name}.damaged").unlink()
    path.write_bytes(whole)
    assert store.status(KEY) == "done"


@pytest.mark.parametrize("kept", [0, 1, 8, 400, -1])
def test_truncated_shard_is_set_aside_with_a_warning(store, caplog, kept):
    path = store.path(KEY)
    path.write_bytes(path.read_bytes()[:kept])
    assert store.read(KEY) is None
    assert damaged(store) == [f"{path.name}.damaged"]
    (record,) = caplog.records
    assert record.levelname == "WARNING"
    assert path.name in record.message


def test_damaged_shards_do_not_overwrite_each_other(store, rows):
    path = store.path(KEY)
    for number in range(3):
        path.write_bytes(b"bad" * number)
        assert store.read(KEY) is None
    assert damaged(store) == [
        f"{path.name}.2.damaged",
        f"{path.name}.3.damaged",
        f"{path.name}.damaged",
    ]
    assert (store.cases / f"{path.name}.2.damaged").read_bytes() == b"bad"


def test_shard_of_another_block_is_no_shard(store):
    store.path(OTHER).write_bytes(store.path(KEY).read_bytes())
    assert store.read(OTHER) is None
    assert damaged(store) == [f"{store.path(OTHER).name}.damaged"]
    assert store.status(KEY) == "done"


def test_one_failed_row_makes_a_failed_shard(store, rows):
    rows.loc[1, "status"] = "failed"
    store.write(KEY, encode(KEY, rows, {}))
    assert store.status(KEY) == "failed"
    assert len(store.read(KEY)) == 3


def test_read_all_keeps_order_names_the_missing_and_joins_older_columns(store, rows):
    store.write(
        OTHER, encode(OTHER, rows.drop(columns="amplitude").assign(replicate=[7, 8, 9]), {})
    )
    read, missing = store.read_all([OTHER, "f" * 32, KEY])
    assert missing == ["f" * 32]
    assert list(read["replicate"]) == [7, 8, 9, 0, 1, 2]
    assert read["amplitude"].isna().sum() == 4
    assert store.read_all(["f" * 32]) == (None, ["f" * 32])


def test_clear_deletes_shards_and_nothing_else(store):
    path = store.path(KEY)
    (store.cases / f"{path.name}.damaged").write_text("")
    (store.cases / f".{path.name}.0a.tmp").write_text("")
    (store.cases / "notes.txt").write_text("mine")
    store.clear()
    assert [found.name for found in store.cases.iterdir()] == ["notes.txt"]
